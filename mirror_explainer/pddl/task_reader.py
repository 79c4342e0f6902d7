"""Tasks read one after the other, as a robot's state changes: only what changed is read.

Most problems that a robot publishes differ from the last in the facts of their :init and in
nothing else. Then these are read, and the rest is taken over.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import unified_planning.model as up

from mirror_explainer.errors import InputError
from mirror_explainer.input_limits import InputLimits
from mirror_explainer.pddl.atoms import atom_text
from mirror_explainer.pddl.environment import forget_expressions
from mirror_explainer.pddl.expressions import Expressions
from mirror_explainer.pddl.task import Task, read_task
from mirror_explainer.pddl.text.sections import section
from mirror_explainer.pddl.text.tree import Branch, Tree, Word, as_text, parse
from mirror_explainer.text_files import plain_text

# unified-planning keeps every expression, so that now and then all must be read afresh.
_MOST_IN_A_ROW = 1000


class TaskReader:
    """Reads tasks; each that it returns makes those before it useless.

    Like unified-planning, it must be used from one thread at a time.
    """

    def __init__(self) -> None:
        self._last: _Read | None = None
        self._in_a_row = 0

    def read(
        self,
        domain: str,
        problem: str,
        domain_source: str = 'domain',
        problem_source: str = 'problem',
        limits: InputLimits | None = None,
        stop: Callable[[], None] | None = None,
    ) -> Task:
        """Read a task as `read_task` does. Raises InputError."""
        given = (domain, domain_source, problem_source, limits)
        last, self._last = self._last, None
        if last and last.given == given and self._in_a_row < _MOST_IN_A_ROW:
            task = last.with_state_of(problem, stop)
            if task is not None:
                self._in_a_row += 1
                self._last = last
                return task
        self._in_a_row = 0
        forget_expressions()
        task = read_task(domain, problem, domain_source, problem_source, limits, stop)
        self._last = _Read(given, plain_text(problem), task)
        return task


@dataclass(frozen=True)
class _State:
    """An :init, taken apart: plain facts, and everything else."""

    facts: Mapping[tuple[str, ...], Branch]
    others: list[Tree]


@dataclass
class _Read:
    """A task that was read whole, from this problem and the other things given."""

    given: tuple[str, str, str, InputLimits | None]
    problem: str
    task: Task

    def with_state_of(self, problem: str, stop: Callable[[], None] | None) -> Task | None:
        """Return the task in the state that another problem has.

        None if that differs in more than plain facts, or has something wrong with it.
        """
        found = self._state_in(problem, stop)
        if found is None or self._first is None or found.others != self._first.others:
            return None
        atoms = [self._atom(words) for words in found.facts]
        known = [atom for atom in atoms if atom is not None]
        if len(known) < len(atoms):
            return None
        timed = self.task.timed
        return replace(
            self.task,
            problem=self._text_with(found),
            model=self._model_with(self.task.model, known),
            timed=None if timed is None else self._model_with(timed, known),
        )

    @cached_property
    def _place(self) -> tuple[str, str] | None:
        """What stands before the :init, and what after it; None if it has none."""
        init = section(self.problem, ':init')
        return None if init is None else (self.problem[: init.start], self.problem[init.end :])

    @cached_property
    def _first(self) -> _State | None:
        """The state in which the task was read."""
        return self._state_in(self.problem, None)

    @cached_property
    def _atoms(self) -> dict[tuple[str, ...], up.FNode]:
        return {}

    @cached_property
    def _kept(self) -> dict[int, dict[up.FNode, up.FNode]]:
        """For each model, the initial values that are no facts of the :init."""
        return {}

    @cached_property
    def _expressions(self) -> Expressions:
        return Expressions(self.task.model)

    @cached_property
    def _made_up(self) -> list[Tree]:
        """What the :init for planners has besides the facts that were read."""
        init = section(self.task.problem, ':init')
        assert init is not None and self._first is not None
        (tree,) = parse(self.task.problem[init.start : init.end], '')
        known = {as_text(part) for part in self._first.facts.values()} - self.task.facts_to_come
        assert isinstance(tree, Branch)
        return [part for part in tree[1:] if as_text(part) not in known]

    def _state_in(self, problem: str, stop: Callable[[], None] | None) -> _State | None:
        """Return the state in a problem that differs from this one in its :init only."""
        limits, text = self.given[3], plain_text(problem)
        if limits:
            limits.require_bytes(text, self.given[2])
        if self._place is None:
            return None
        before, after = self._place
        if len(text) < len(before) + len(after):
            return None
        if not text.startswith(before) or not text.endswith(after):
            return None
        try:
            trees = parse(text[len(before) : len(text) - len(after)], '', stop)
        except InputError:  # reading it whole will say so, with the right line
            return None
        if len(trees) != 1 or not isinstance(trees[0], Branch) or trees[0].head != ':init':
            return None
        facts: dict[tuple[str, ...], Branch] = {}
        others: list[Tree] = []
        for part in trees[0][1:]:
            if isinstance(part, Branch) and self._is_plain(part):
                facts[tuple(map(str, part))] = part
            else:
                others.append(part)
        return _State(facts, others)

    @cached_property
    def _predicates(self) -> frozenset[str]:
        """The predicates whose facts an :init may have."""
        named = {f.name for f in self.task.model.fluents if f.type.is_bool_type()}
        return frozenset(named - (self.task.axioms.names if self.task.axioms else set()))

    def _is_plain(self, part: Branch) -> bool:
        return part.head in self._predicates and all(isinstance(word, Word) for word in part)

    def _atom(self, words: tuple[str, ...]) -> up.FNode | None:
        """Return the expression of a fact, None if it does not fit the declarations."""
        if words not in self._atoms:
            atom = self._expressions.atom(list(words), {})
            if self._expressions.faults:
                return None
            self._atoms[words] = atom
        return self._atoms[words]

    def _model_with(self, model: up.Problem, atoms: list[up.FNode]) -> up.Problem:
        """Return a model with other facts."""
        copy = model.clone()
        values = copy.explicit_initial_values
        if id(model) not in self._kept:
            assert self._first is not None
            first = {f'({" ".join(words)})' for words in self._first.facts}
            first -= self.task.facts_to_come
            kept = {atom: value for atom, value in values.items() if atom_text(atom) not in first}
            self._kept[id(model)] = kept
        values.clear()
        values.update(self._kept[id(model)])
        values.update(dict.fromkeys(atoms, model.environment.expression_manager.TRUE()))
        return copy

    def _text_with(self, state: _State) -> str:
        """Return the problem for planners in a state."""
        init = section(self.task.problem, ':init')
        assert init is not None
        parts = map(as_text, (*state.facts.values(), *self._made_up))
        listed = '\n'.join(dict.fromkeys(parts))
        before, after = self.task.problem[: init.start], self.task.problem[init.end :]
        return f'{before}(:init {listed}){after}'
