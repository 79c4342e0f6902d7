"""PDDL as text: its sections and lines, and what is refused by name and line."""
