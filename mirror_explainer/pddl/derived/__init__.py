"""Derived predicates: what follows from the facts of a state."""
