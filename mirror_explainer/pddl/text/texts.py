"""A domain and a problem as texts, with what errors call them."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Texts:
    """Two PDDL texts that go together; the sources are the files or topics they came from."""

    domain: str
    problem: str
    domain_source: str
    problem_source: str
