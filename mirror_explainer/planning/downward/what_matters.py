"""What matters to one goal: no optimal plan needs the operators and variables left out here.

Every search gets a task of its own, mostly much smaller than what was grounded for all beliefs.
Costs stay exact: whatever plan uses an operator left out, there is one without it that is
no dearer.
"""

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from functools import cached_property

from mirror_explainer.planning.downward.ground_task import Fact, GroundTask, Operator, State
from mirror_explainer.planning.downward.search_task import Numbering, SearchTask


class GoalTask:
    """One goal of a ground task: what matters to it, from each initial state.

    `operators` are those that can help; nothing but `variables` matters.
    """

    def __init__(self, task: GroundTask, goal: tuple[Fact, ...]) -> None:
        self.goal = goal
        self.operators = helpful(_without_stops(helpful(task.operators, goal), goal), goal)
        self.variables = {v for o in self.operators for v in o.needs} | {v for v, _ in goal}
        self._sizes = task.sizes
        self._relaxation = Relaxation(self.operators)
        self._from_here: dict[State, tuple[SearchTask, State]] = {}

    def may_be_reached(self, state: State) -> bool:
        """Say whether the goal could be reached if nothing ever became false."""
        return self._relaxation.reached(state)[1].issuperset(self.goal)

    def from_any(self, state: State) -> tuple[SearchTask, State]:
        """Return a search from a state, by what matters from whatever state."""
        return self._whole.task, self._whole.state(state)

    @cached_property
    def _whole(self) -> Numbering:
        return Numbering(self._sizes, self.operators, self.goal, self.variables)

    def from_here(self, state: State) -> tuple[SearchTask, State]:
        """Return a search from a state that may reach the goal, by what matters from there."""
        if state in self._from_here:
            return self._from_here[state]
        usable, _ = self._relaxation.reached(state)
        changing = {
            variable
            for index in usable
            for variable, value in self.operators[index].changes.items()
            if value != state[variable]
        }
        # The others only make true what always is.
        left = [o for o in map(self.operators.__getitem__, usable) if changing & o.changes.keys()]
        direct = _without_detours(helpful(left, self.goal), state, self.goal)
        operators = helpful(direct, self.goal)
        changed = {variable for operator in operators for variable in operator.changes}
        numbering = Numbering(self._sizes, operators, self.goal, changed)
        return self._from_here.setdefault(state, (numbering.task, numbering.state(state)))


def helpful(operators: Sequence[Operator], goal: Iterable[Fact]) -> list[Operator]:
    """Return the operators that bring about the goal, or what one of these needs.

    A plan stays one without the others: every fact that is needed is true as it was.
    """
    bringing = defaultdict(list)
    for index, operator in enumerate(operators):
        for fact in operator.changes.items():
            bringing[fact].append(index)
    found: set[int] = set()
    needed = set(goal)
    open_facts = list(needed)
    while open_facts:
        for index in bringing.get(open_facts.pop(), ()):
            if index not in found:
                found.add(index)
                new = set(operators[index].condition) - needed
                needed |= new
                open_facts += new
    return [operators[index] for index in sorted(found)]


def _without_stops(operators: Sequence[Operator], goal: Iterable[Fact]) -> list[Operator]:
    """Leave out moves to where one can only move on, if one can as well move on from before.

    A lift need not stop where nobody waits or wants to go: one move is cheaper than two.
    """
    onward: dict[Fact, dict[Fact, list[Operator]]] = defaultdict(lambda: defaultdict(list))
    wanted = set(goal)
    for operator in operators:
        move = _as_move(operator)
        if move:
            onward[move[0]][move[1]].append(operator)
        wanted.update(fact for fact in operator.condition if not move or fact != move[0])

    def needless(into: Operator) -> bool:
        move = _as_move(into)
        if move is None or move[1] in wanted:
            return False
        before, stop = move
        return all(
            any(
                direct.cost < into.cost + on.cost
                and on.needs.items() >= direct.needs.items() - {before}
                for direct in onward[before][there]
            )
            for there, operators in onward[stop].items()
            if there != before
            for on in operators
        )

    return [operator for operator in operators if not needless(operator)]


def _as_move(operator: Operator) -> tuple[Fact, Fact] | None:
    """Return from which value to which an operator changes its one variable, or None."""
    if len(operator.changes) != 1:
        return None
    [(variable, value)] = operator.changes.items()
    before = operator.needs.get(variable)
    return None if before is None else ((variable, before), (variable, value))


class Relaxation:
    """What operators could reach if nothing ever became false."""

    def __init__(self, operators: Sequence[Operator]) -> None:
        self._effects = [operator.effect for operator in operators]
        self._missing = [len(operator.condition) for operator in operators]
        self._needed_by: dict[Fact, list[int]] = defaultdict(list)
        for index, operator in enumerate(operators):
            for fact in operator.condition:
                self._needed_by[fact].append(index)

    def reached(self, state: State, without: Iterable[int] = ()) -> tuple[list[int], set[Fact]]:
        """Return the indices of the operators that can be applied, and the facts reached."""
        missing = list(self._missing)
        for index in without:
            missing[index] = -1
        usable = [index for index, count in enumerate(missing) if not count]
        reached = set(enumerate(state))
        for index in usable:
            reached.update(self._effects[index])
        open_facts = list(reached)
        while open_facts:
            for index in self._needed_by.get(open_facts.pop(), ()):
                missing[index] -= 1
                if not missing[index]:
                    usable.append(index)
                    for fact in self._effects[index]:
                        if fact not in reached:
                            reached.add(fact)
                            open_facts.append(fact)
        return sorted(usable), reached


def _without_detours(
    operators: Sequence[Operator], state: State, goal: Sequence[Fact]
) -> list[Operator]:
    """Leave out what only leads away and back, such as to fetch what the goal does not name.

    For each variable that nothing reads without changing it: leave out all that change it, and
    whatever then cannot be reached, if every plan works without them.
    """
    relaxation = Relaxation(operators)
    changing: dict[int, set[int]] = defaultdict(set)
    uses: Counter[Fact] = Counter(goal)
    read = {variable for variable, _ in goal}
    for index, operator in enumerate(operators):
        uses.update({*operator.condition, *operator.effect})
        read.update(operator.needs.keys() - operator.changes.keys())
        for variable in operator.changes:
            changing[variable].add(index)
    gone: set[int] = set()
    for variable in sorted(changing.keys() - read):
        if not changing[variable] <= gone:
            usable, reached = relaxation.reached(state, gone | changing[variable])
            more = set(range(len(operators))) - gone - set(usable)
            spared = [operators[index] for index in more]
            if reached.issuperset(goal) and _are_spared(spared, uses, state):
                gone |= more
    return [operator for index, operator in enumerate(operators) if index not in gone]


def _are_spared(gone: Sequence[Operator], uses: Counter[Fact], state: State) -> bool:
    """Say whether no plan needs these operators.

    `uses` counts the operators that mention a fact; those of `gone` are taken off where they are
    spared. Where a plan changes a value by what is left out, the value stays as it was. That goes
    well if no two values matter to what is kept that such changes connect: then, whenever one of
    them is needed, it is the one that stayed.
    """
    touched = {v for operator in gone for v in operator.changes}
    left = uses - Counter(f for o in gone for f in {*o.condition, *o.effect})
    matter = {fact for fact in left if fact[0] in touched} | {(v, state[v]) for v in touched}
    leader: dict[Fact, Fact] = {}

    def lead(fact: Fact) -> Fact:
        while leader.setdefault(fact, fact) != fact:
            fact = leader[fact]
        return fact

    for operator in gone:
        for variable, value in operator.changes.items():
            before = operator.needs.get(variable)
            if before is None:
                sources = {fact for fact in uses if fact[0] == variable} | {
                    (variable, state[variable])
                }
            else:
                sources = {(variable, before)}
            for source in sources:
                leader[lead(source)] = lead((variable, value))
    if len({lead(fact) for fact in matter}) < len(matter):
        return False
    uses.subtract(uses - left)
    return True
