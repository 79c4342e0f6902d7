"""The derived facts of states, worked out where they are asked for, and remembered."""

from mirror_explainer.errors import InputError
from mirror_explainer.pddl.atoms import ground_text, words_of
from mirror_explainer.pddl.derived.axioms import Axioms
from mirror_explainer.pddl.derived.datalog import ExplosionError, consequences

# Working out what holds in all states that a plan goes through may take some seconds, no more.
_MOST_STEPS = 1_000_000


class DerivedFacts:
    """What holds by the axioms, if there are any, in states given as the facts that are true."""

    def __init__(self, axioms: Axioms | None) -> None:
        self._axioms = axioms
        self._left = _MOST_STEPS
        self._basis: dict[str, frozenset[str]] = {}
        self._known: dict[tuple[str, frozenset[str]], frozenset[str]] = {}

    @property
    def names(self) -> frozenset[str]:
        """The predicates that are derived."""
        return self._axioms.names if self._axioms else frozenset()

    def hold(self, atom: str, facts: frozenset[str]) -> bool:
        """Say whether the atom is derived, and holds.

        Raises InputError where it takes too long to work that out.
        """
        if self._axioms is None:
            return False
        predicate = words_of(atom)[0]
        if predicate not in self._axioms.names:
            return False
        if (predicate, facts) not in self._known:
            self._known[predicate, facts] = self._of(predicate, facts, self._axioms)
        return atom in self._known[predicate, facts]

    def _of(self, predicate: str, facts: frozenset[str], axioms: Axioms) -> frozenset[str]:
        """Return the atoms of a derived predicate: the same where what it rests on is."""
        if predicate not in self._basis:
            self._basis[predicate] = axioms.basis([predicate])
        basis = self._basis[predicate]
        given = frozenset(fact for fact in facts if words_of(fact)[0] in basis)
        if (predicate, given) not in self._known:
            rules = [rule for rule in axioms.rules if rule.head.predicate in basis]
            words = (tuple(words_of(fact)) for fact in given)
            try:
                found, self._left = consequences(rules, [*axioms.given, *words], self._left)
            except ExplosionError as error:
                raise InputError(
                    axioms.source,
                    'its derived predicates hold of too many objects, or look at too many, to be '
                    'worked out in time',
                    cure='Give them fewer arguments, or arguments of narrower types.',
                ) from error
            self._known[predicate, given] = frozenset(
                ground_text(name, objects) for name, *objects in found if name == predicate
            )
        return self._known[predicate, given]
