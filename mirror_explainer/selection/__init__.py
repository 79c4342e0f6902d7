"""Which steps to say: Algorithm 1 of the paper. Knows no PDDL and no robot."""
