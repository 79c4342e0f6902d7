"""One grounding for every belief of a space, and what it takes for it to stay right.

A robot's step changes the initial state and nothing else of a problem; mostly
the grounding then serves again.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from mirror_explainer.planning.downward.ground_task import Fact, GroundTask, State


@dataclass(frozen=True)
class Grounding:
    """A task grounded for all beliefs of a space, and of some spaces that differ in their state.

    `goals` has the facts of each goal; None for a goal no belief can reach.
    `hard_goals` are the goals that one conjunction does not express.
    `negative` are the atoms that some condition requires to be false.
    `variables` are the variables' value names before those that matter to no
    goal were left out, `kept` the ones that were kept, in the task's order.
    `mutexes` are groups of atoms of which one at most may hold initially.
    `objects` are all objects, as declared.
    """

    goals: tuple[tuple[Fact, ...] | None, ...]
    hard_goals: frozenset[int]
    initial: frozenset[str]
    uncertain: tuple[str, ...]
    objects: tuple[str, ...]
    task: GroundTask = GroundTask(())
    negative: frozenset[str] = frozenset()
    variables: tuple[tuple[str, ...], ...] = ()
    kept: tuple[int, ...] = ()
    mutexes: tuple[frozenset[str], ...] = ()

    def initial_state(self, atoms: frozenset[str]) -> State | None:
        """Return the state in which exactly these atoms hold, None if there is no such state."""
        state = [self._value(variable, atoms) for variable in self.kept]
        return None if None in state else tuple(v for v in state if v is not None)

    def _value(self, variable: int, atoms: frozenset[str]) -> int | None:
        names = self.variables[variable]
        true = [value for value, name in enumerate(names) if name in atoms]
        # If none of its atoms holds, a variable has the value that is no atom, if there is one.
        values = true or [v for v, name in enumerate(names) if not name.startswith('Atom ')]
        return values[0] if len(values) == 1 else None

    def atoms(self, variables: Iterable[int]) -> frozenset[str]:
        """Return the atoms that variables of the task stand for."""
        return frozenset(name for v in variables for name in self.variables[self.kept[v]])

    def holds_for(self, initial: frozenset[str]) -> bool:
        """Say whether the grounding is right for another initial state of the same problem.

        It is if all that differs was found changeable, so that no more is
        reachable from there, and if the invariants it rests on hold there.
        """
        full = initial | frozenset(self.uncertain)
        return (
            (initial ^ self.initial) - frozenset(self.uncertain)
            <= frozenset().union(*self.variables)
            and all(len(group & full) <= 1 for group in self.mutexes)
            and all(self._value(v, full) is not None for v in range(len(self.variables)))
        )


def atom_name(words: Sequence[str]) -> str:
    """Return an atom as the translator names it: "Atom at(ball, room)"."""
    return f'Atom {words[0]}({", ".join(words[1:])})'
