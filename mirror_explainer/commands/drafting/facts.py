"""What a listener might not know: facts whose other truth changes what a rational robot does.

Which these are the planner says: some candidate goals are planned for as things are, and with
one fact the other way round. A fact without which nothing can be done is none of them, nor one
that changes no plan.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import unified_planning.model as up

from mirror_explainer.commands.drafting.patterns import World
from mirror_explainer.pddl import conjuncts, words_of
from mirror_explainer.pddl.atoms import effects_in
from mirror_explainer.planning import Belief, BeliefPlans, BeliefSpace, Planner, Status

MOST_FACTS = 6
MOST_GROUPS = 3  # and no more than facts, but one
# How many facts are tried, for as many goals.
_TRIED_FACTS = 40
_TRIED_GOALS = 6


@dataclass(frozen=True)
class Doubts:
    """Facts to doubt, and groups of facts of which one holds, the true one first.

    `tried` are the facts that were tried; not `complete` if there was not time for all.
    """

    facts: tuple[str, ...]
    groups: tuple[tuple[str, ...], ...]
    tried: int
    complete: bool


@dataclass(frozen=True)
class _Possible:
    """Looks at the domain for facts that may be otherwise."""

    world: World
    goals: Sequence[tuple[str, ...]]

    @cached_property
    def _model(self) -> up.Problem:
        return self.world.task.model

    @cached_property
    def _initial(self) -> frozenset[str]:
        return self.world.task.initial_facts

    @cached_property
    def _aimed_at(self) -> set[str]:
        """The predicates of goals: that one is reached already is no doubt about the world."""
        return {words_of(part.replace('(not ', ''))[0] for goal in self.goals for part in goal}

    @cached_property
    def _static(self) -> set[str]:
        changing = {
            effect.fluent.fluent().name.lower()
            for action in self._model.actions
            for effect in effects_in(action)
        }
        return {fluent.name.lower() for fluent in self._model.fluents} - changing

    def needed(self, plan: Iterable[str]) -> Iterator[str]:
        """Yield what holds initially and an action of a plan needs: of one object at most.

        Of more objects only what actions change: a map is not doubted.
        """
        for step in plan:
            name, *objects = words_of(step)
            action = self._model.action(name)
            bound = {p.name: o for p, o in zip(action.parameters, objects, strict=True)}
            for condition in action.preconditions:
                for part in conjuncts(condition):
                    atom = _ground(part, bound)
                    if atom in self._initial and self._may_be_doubted(atom):
                        yield atom

    def _may_be_doubted(self, atom: str) -> bool:
        predicate, *objects = words_of(atom)
        if predicate in self._aimed_at:
            return False
        return len(objects) <= 1 or predicate not in self._static

    def absent(self) -> Iterator[str]:
        """Yield what does not hold, an action can bring about, and another needs.

        Not where bringing it about undoes something that holds: the two exclude each other.
        """
        needed = {
            atom.fluent().name
            for action in self._model.actions
            for condition in action.preconditions
            for atom in conjuncts(condition)
            if atom.is_fluent_exp()
        }
        for fluent in self._model.fluents:
            if not fluent.type.is_bool_type() or fluent.arity > 1 or fluent.name not in needed:
                continue
            kinds = [parameter.type for parameter in fluent.signature]
            choices = [[o.name.lower()] for o in self._model.objects(kinds[0])] if kinds else [[]]
            for objects in choices:
                atom = f'({" ".join([fluent.name.lower(), *objects])})'
                if atom not in self._initial and self._may_be_doubted(atom) and self._free(atom):
                    yield atom

    def _free(self, atom: str) -> bool:
        """Say whether some action brings an atom about and undoes nothing that holds."""
        predicate, *objects = words_of(atom)
        for action in self._model.actions:
            effects = effects_in(action)
            for effect in effects:
                if not effect.value.is_true() or effect.fluent.fluent().name.lower() != predicate:
                    continue
                names = [a.parameter().name for a in effect.fluent.args if a.is_parameter_exp()]
                bound = dict(zip(names, objects, strict=False))
                undone = [e.fluent for e in effects if e.value.is_false()]
                if not any(self._holds_some(fluent, bound) for fluent in undone):
                    return True
        return False

    def _holds_some(self, fluent: up.FNode, bound: Mapping[str, str]) -> bool:
        """Say whether a fact of this form holds, whatever the other parameters are."""
        form = [
            bound.get(a.parameter().name) if a.is_parameter_exp() else str(a).lower()
            for a in fluent.args
        ]
        name = fluent.fluent().name.lower()
        return any(
            words[0] == name and all(f in (None, w) for f, w in zip(form, words[1:], strict=True))
            for words in map(words_of, self._initial)
        )

    def places(self) -> Iterator[tuple[str, ...]]:
        """Yield, for each thing of the robot's goal, where it is and where others like it are.

        A place is told by a fact of two objects that actions change, with one for each thing.
        """
        things = dict.fromkeys(
            word for part in self.goals[0] for word in words_of(part) if word in self.world.types
        )
        by_predicate: dict[str, list[list[str]]] = {}
        for predicate, *objects in map(words_of, sorted(self._initial)):
            if len(objects) == 2 and predicate not in self._static | self._aimed_at:
                by_predicate.setdefault(predicate, []).append(objects)
        for predicate, pairs in by_predicate.items():
            for thing, place in ((0, 1), (1, 0)):
                named = [pair[thing] for pair in pairs]
                where = list(dict.fromkeys(pair[place] for pair in pairs))
                if len(set(named)) < len(named) or len(where) < 2:
                    continue
                for pair in pairs:
                    if pair[thing] in things:
                        own = pair[place]
                        ordered = [own, *(other for other in where if other != own)]
                        yield tuple(_at(predicate, pair, place, other) for other in ordered)


def _at(predicate: str, pair: Sequence[str], place: int, other: str) -> str:
    objects = [other if position == place else item for position, item in enumerate(pair)]
    return f'({predicate} {" ".join(objects)})'


def _ground(condition: up.FNode, bound: Mapping[str, str]) -> str:
    """Return the atom that a literal is about, '' for another condition."""
    atom = condition.arg(0) if condition.is_not() else condition
    if not atom.is_fluent_exp():
        return ''
    words = [
        bound[a.parameter().name] if a.is_parameter_exp() else str(a).lower() for a in atom.args
    ]
    return f'({" ".join([atom.fluent().name.lower(), *words])})'


def doubts(
    world: World,
    goals: Sequence[tuple[str, ...]],
    robot_plan: Sequence[str],
    planner: Planner,
    deadline: float,
) -> Doubts:
    """Return what to doubt; `goals` are candidates by their parts, the robot's own first.

    Raises PlanningError and InputError as `Planner.plan` does.
    """
    possible = _Possible(world, goals)
    goals = goals[:_TRIED_GOALS]
    texts = tuple(f'(and {" ".join(goal)})' for goal in goals)
    task = world.task
    space = BeliefSpace(task.domain, task.problem, texts)
    first = planner.plan(space, [Belief(g) for g in range(len(goals))], deadline=deadline / 2)
    plans = [robot_plan, *(r.plans[0].actions for r in first.results if r.status is Status.SOLVED)]
    needed = [fact for plan in plans for fact in possible.needed(plan)]
    few = sorted(dict.fromkeys([*needed, *possible.absent()]), key=lambda f: len(words_of(f)))
    tried = few[:_TRIED_FACTS]
    groups = list(possible.places())[: 2 * MOST_GROUPS]
    changes = [frozenset([fact]) for fact in tried]
    changes += [change for group in groups for change in _moves(group)]
    named = tuple(sorted(frozenset().union(*changes))) if changes else ()
    held = frozenset(named) & task.initial_facts
    space = BeliefSpace(task.domain, task.problem, texts, named)
    beliefs = [Belief(g, held ^ change) for change in changes for g in range(len(goals))]
    asked = [*(Belief(g, held) for g in range(len(goals))), *beliefs]
    report = planner.plan(space, asked, deadline=deadline) if changes else first
    found = dict(zip(asked, report.results, strict=True)) if changes else {}
    usual = [found.get(Belief(g, held)) for g in range(len(goals))]

    def effect(change: frozenset[str]) -> list[str]:
        """Say of each goal whether a change leads to another plan."""
        results = (found[Belief(g, held ^ change)] for g in range(len(goals)))
        return [_effect(possible, *pair, change) for pair in zip(usual, results, strict=True)]

    told = [f for f in tried if {'cost', 'other'} & set(effect(frozenset([f])))]
    told = sorted(told, key=lambda f: (len(words_of(f)), f not in needed))[:MOST_FACTS]
    # First the places that are nearer or farther, then those that are only elsewhere.
    moved = {group: [effect(change) for change in _moves(group)] for group in groups}
    farther, elsewhere = (
        [group for group in groups if all(_lead_to(kinds, e) for e in moved[group])]
        for kinds in ({'cost'}, {'cost', 'other'})
    )
    kept = list(dict.fromkeys([*farther, *elsewhere]))
    return Doubts(
        tuple(told),
        tuple(kept[: min(MOST_GROUPS, max(1, len(told)))]),
        len(tried),
        all(result.status is not Status.UNKNOWN for result in report.results),
    )


def _effect(
    possible: _Possible, usual: BeliefPlans | None, now: BeliefPlans, change: frozenset[str]
) -> str:
    """Say what a change does to a goal's plan: 'none' left, another 'cost', an 'other' plan."""
    if usual is None or usual.status is not Status.SOLVED:
        return ''
    if now.status is not Status.SOLVED:
        return 'none' if now.status is Status.UNSOLVABLE else ''
    if now.plans[0].cost != usual.plans[0].cost:
        return 'cost'
    return 'other' if change & set(possible.needed(usual.plans[0].actions)) else ''


def _moves(group: Sequence[str]) -> list[frozenset[str]]:
    """Return the changes that make another fact of a group true than the first."""
    return [frozenset([group[0], other]) for other in group[1:]]


def _lead_to(kinds: set[str], effects: Sequence[str]) -> bool:
    """Say whether a change has an effect of these kinds on some plan, and leaves each goal one."""
    return not kinds.isdisjoint(effects) and 'none' not in effects
