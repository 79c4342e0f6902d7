"""Little robots without a planner, and the method written a second time, from its definitions.

Nothing here uses the package's own mathematics: tests compare it with this.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from random import Random

from mirror_explainer.listener.ends import aims
from mirror_explainer.listener.goals import Part
from mirror_explainer.listener.listeners import Listener
from mirror_explainer.listener.mirror_model import MirrorModel
from mirror_explainer.listener.prior import Prior
from mirror_explainer.listener.user_model import CandidateGoal
from mirror_explainer.listener.way import Way
from mirror_explainer.listener.weighing import mirror_model
from mirror_explainer.planning import Belief, BeliefPlans, BeliefSpace, Plan, Status

FACT = '(f)'


@dataclass(frozen=True)
class Robot:
    """All that a mirror model is made from.

    `goals` are sets of parts, the robot's own first; `truth` says where each part holds, from
    the state before the first step on. `beliefs` have a goal, whether FACT holds, and P(b);
    `found` what planning found of each: plans with costs, 'unsolvable' or 'unknown'.
    """

    goals: tuple[frozenset[str], ...]
    truth: dict[str, list[bool]]
    plan: tuple[str, ...]
    cost: float
    beliefs: tuple[tuple[int, bool, float], ...]
    found: tuple[object, ...]
    masses: tuple[float, ...]
    fact: float
    one_plan: bool
    rationality: float

    def model(self, listener: Listener) -> MirrorModel:
        """The package's mirror model of it."""
        parts = [tuple(Part(name, None) for name in sorted(goal)) for goal in self.goals]
        beliefs = tuple(
            Belief(goal, frozenset([FACT] if holds else [])) for goal, holds, _ in self.beliefs
        )
        goals = tuple(
            CandidateGoal(f'goal {i}', f'(g{i})', mass) for i, mass in enumerate(self.masses)
        )
        prior = Prior(
            BeliefSpace('', '', tuple(goal.goal for goal in goals), (FACT,)),
            goals,
            tuple(parts),
            {FACT: self.fact},
            beliefs,
            tuple(p for _, _, p in self.beliefs),
            0,
            self.masses,
            (),
        )
        truth = {Part(name, None): held for name, held in self.truth.items()}
        seen_by = aims(prior.parts, truth, range(len(self.plan)))
        results = {
            belief: BeliefPlans(Status(found))
            if isinstance(found, str)
            else BeliefPlans(Status.SOLVED, tuple(Plan(*plan) for plan in found))
            for belief, found in zip(beliefs, self.found, strict=True)
        }
        return mirror_model(
            prior,
            results,
            Way(Plan(self.plan, self.cost), said, seen_by),
            listener,
            self.rationality,
            one_plan=self.one_plan,
        )


def said(action: str) -> str:
    """The sentence of an action: (a x) and (b x) are one, and so on."""
    return f'I do {action.strip("()").split()[1]}.'


def draw_courier(seed: int) -> Robot:
    """Draw a robot that brings things to places, maybe by a detour, and charges if it must."""
    random = Random(seed)
    things = {f'd{i}': random.choice('klm') for i in range(random.randint(2, 5))}

    def way(goal: frozenset[str], charged: bool) -> list[str]:
        steps = [] if charged else ['(a charge)']
        for place in 'klm':
            here = sorted(thing for thing in goal if things[thing] == place)
            steps += [f'(a {place})', *(f'(a {thing})' for thing in here)] if here else []
        return steps

    subsets = [
        frozenset(c) for n in range(1, len(things) + 1) for c in itertools.combinations(things, n)
    ]
    goals = tuple(random.sample(subsets, min(len(subsets), random.randint(1, 5))))
    fact = random.choice([0.3, 0.5, 0.9, 1.0])
    masses = tuple(1 / len(goals) for _ in goals)
    own_charge = random.random() < fact
    beliefs = [
        (goal, charged, (fact if charged else 1 - fact) * masses[goal])
        for goal in range(len(goals))
        for charged in (own_charge, not own_charge)
        if (fact if charged else 1 - fact) > 0
    ]
    plan = way(goals[0], own_charge)
    if random.random() < 0.3:
        plan.insert(random.randrange(len(plan)), '(a detour)')
    done = [{step[3:-1] for step in plan[:i]} for i in range(len(plan) + 1)]
    found: list[object] = [
        random.choice([((tuple(way(goals[goal], charged)), 1.0),)] * 4 + ['unknown'])
        for goal, charged, _ in beliefs
    ]
    found[0] = ((tuple(way(goals[0], own_charge)), 1.0),)  # the first that is planned for
    if random.random() < 0.2:
        found = ['unknown'] * len(beliefs)
    truth = {thing: [thing in there for there in done] for thing in things}
    return Robot(
        goals, truth, tuple(plan), 1.0, tuple(beliefs), tuple(found), masses, fact, True, 1.0
    )


def draw_robot(seed: int) -> Robot:
    """Draw a robot whose ways and truths are whatever comes; the same for the same seed."""
    random = Random(seed)
    length = random.randint(1, 7)
    names = ['p', 'q', 'r', 's'][: random.randint(1, 4)]
    truth = {name: [random.random() < 0.4 for _ in range(length + 1)] for name in names}
    own = frozenset(random.sample(names, random.randint(1, len(names))))
    for name in own:
        truth[name][-1] = True
    subsets = [
        frozenset(c) for n in range(1, len(names) + 1) for c in itertools.combinations(names, n)
    ]
    others = random.sample([s for s in subsets if s != own], min(len(subsets) - 1, 3))
    goals = (own, *others[: random.randint(0, 3)])
    actions = [f'({verb} {thing})' for verb in 'ab' for thing in 'uvwxyz'[: random.randint(2, 6)]]
    plan = tuple(random.choice(actions) for _ in range(length))
    fact = random.choice([0.3, 0.5, 0.9])
    masses = [random.choice([1, 2, 5]) for _ in goals]
    masses = [mass / sum(masses) for mass in masses]
    beliefs = [
        (goal, holds, mass * (fact if holds else 1 - fact))
        for goal, mass in enumerate(masses)
        for holds in (True, False)
    ]
    # Some are not enumerated; the robot's own always is.
    beliefs = beliefs[:1] + [b for b in beliefs[1:] if random.random() < 0.85]

    def plans() -> tuple[tuple[tuple[str, ...], float], ...]:
        lengths = [random.randint(0, 6) for _ in range(3)]
        drawn = {tuple(random.choices([*plan, *actions], k=length)) for length in lengths}
        costs = sorted(float(random.randint(1, 4)) for _ in drawn)
        return tuple(zip(sorted(drawn), costs, strict=True))[: random.randint(1, 3)]

    found: list[object] = [
        random.choice([plans(), plans(), plans(), 'unknown', 'unsolvable']) for _ in beliefs
    ]
    cost = float(random.randint(1, 4))
    found[0] = random.choice(
        ['unknown', ((plan, cost),), (*plans(), (tuple(reversed(plan)), cost)), plans()]
    )
    if random.random() < 0.2:  # nothing is planned for
        found = ['unknown'] * len(beliefs)
    one_plan = random.random() < 0.7
    if one_plan:
        found = [f if isinstance(f, str) else f[:1] for f in found]
    return Robot(
        goals, truth, plan, cost, tuple(beliefs), tuple(found), tuple(masses), fact, one_plan,
        random.choice([0.0, 1.0, 3.0]),
    )  # fmt: skip


@dataclass(frozen=True)
class Possibility:
    """A way that the listener thinks possible: its mass, goal (None: part of one) and facts."""

    mass: float
    goal: int | None
    fact: bool | None
    fits: dict[str, float]
    is_robot: bool = False


class Definitions:
    """P_R^H, D and the answer by the method's definitions alone."""

    def __init__(self, robot: Robot, listener: Listener) -> None:
        self.robot, self.listener = robot, listener
        self.sentences = [said(action) for action in robot.plan]
        self.told = sorted(set(self.sentences))
        self.open = [
            frozenset(part for part in goal if not all(robot.truth[part])) for goal in robot.goals
        ]
        several = len(robot.goals) > 1
        self.shared = frozenset.intersection(*self.open) if several else frozenset()
        self.ways = self._ways()
        total = sum(way.mass for way in self.ways)
        self.ways = [
            Possibility(w.mass / total, w.goal, w.fact, w.fits, w.is_robot) for w in self.ways
        ]

    def ends(self, parts: frozenset[str]) -> set[str]:
        """The sentences of the positions that achieve one of the parts."""
        found = set()
        for part in parts:
            held = self.robot.truth[part]
            for i in range(len(self.sentences)):
                later = [
                    j for j in range(i + 1, len(self.sentences)) if not held[j] and held[j + 1]
                ]
                if not held[i] and held[i + 1] and not later:
                    found.add(self.sentences[i])
        return found

    def _ways(self) -> list[Possibility]:
        robot, listener = self.robot, self.listener
        mu, omega = listener.unforeseen, listener.partial_goals
        foreseen: list[Possibility] = []
        mine = [0.0] * len(robot.goals)  # the μ-share of each goal
        rest = [0.0] * len(robot.goals)  # what was not planned for
        missing = list(robot.masses)
        for index, ((goal, fact, mass), found) in enumerate(
            zip(robot.beliefs, robot.found, strict=True)
        ):
            missing[goal] -= mass
            plans = [] if isinstance(found, str) else list(found)
            if index == 0:
                plans = self._with_own(plans)
            elif found == 'unsolvable':
                continue
            mine[goal] += mu * mass
            if not plans:
                rest[goal] += (1 - mu) * mass
                continue
            cheapest = min(cost for _, cost in plans)
            likely = [math.exp(-robot.rationality * (cost - cheapest)) for _, cost in plans]
            for place, ((actions, _), p) in enumerate(zip(plans, likely, strict=True)):
                share = (1 - mu) * mass * p / sum(likely)
                is_robot = index == 0 and place == 0
                foreseen.append(Possibility(share, goal, fact, self._foreseen(actions), is_robot))
        own = [way for way in foreseen if way.goal == 0]
        means = {
            s: sum(w.mass for w in own if w.fits[s] > 0) / sum(w.mass for w in own)
            for s in self.told
        }
        ways = list(foreseen)
        for goal, parts in enumerate(self.open):
            mine[goal] += mu * max(0.0, missing[goal])
            rest[goal] += (1 - mu) * max(0.0, missing[goal])
            lacking = [parts - {a} for a in parts - self.shared]
            lacking = [h for h in lacking if h and h not in self.open]
            lent = omega * mine[goal] if lacking else 0.0
            whole = mine[goal] - lent + rest[goal]
            ways.append(Possibility(whole, goal, None, self._unforeseen(parts, means)))
            for h in lacking:
                fits = self._unforeseen(h, means)
                ways.append(Possibility(lent / len(lacking), None, None, fits))
        return ways

    def _with_own(self, plans: list) -> list:
        own = (self.robot.plan, self.robot.cost)
        alike = [p for p in plans if sorted(p[0]) == sorted(own[0])]
        if self.robot.one_plan:
            alike = [p for p in plans if p in alike or p[1] == own[1]]
        return [own, *[p for p in plans if p not in alike[:1]]]

    def _needless(self, sentence: str) -> bool:
        """Whether it is nobody's end, and in no plan that was found for the robot's belief."""
        found = self.robot.found[0]
        if isinstance(found, str):
            return False
        of_any = set().union(*(self.ends(goal) for goal in self.open))
        needed = {said(action) for actions, _ in found for action in actions}
        return sentence not in of_any and sentence not in needed

    def _foreseen(self, actions: Sequence[str]) -> dict[str, float]:
        heard = [said(action) for action in actions]
        if self.listener.kind == 'open':
            return {s: float(s in heard or self._needless(s)) for s in self.told}
        return {
            s: heard.count(s) / len(heard) / (self.sentences.count(s) / len(self.sentences))
            if heard
            else 0.0
            for s in self.told
        }

    def _unforeseen(self, parts: frozenset[str], means: dict[str, float]) -> dict[str, float]:
        own, ends, delta = self.ends(self.open[0]), self.ends(parts), self.listener.other_ends
        of_any = set().union(*(self.ends(goal) for goal in self.open))
        fits = {}
        for s in self.told:
            if s in own and s not in ends:
                fits[s] = delta
            elif s in ends and s not in own:
                fits[s] = 1 / delta
            else:
                is_means = s not in of_any and self.listener.kind == 'open'
                fits[s] = means[s] if is_means else 1.0
        return fits

    def left(self, observed: Sequence[str]) -> list[float]:
        """The mass of each way that is left."""
        return [way.mass * math.prod(way.fits[s] for s in observed) for way in self.ways]

    def goal_posterior(self, observed: Sequence[str]) -> list[float]:
        """P(G = g | o), and last that of goals that lack a part."""
        left = self.left(observed)
        goals = [*range(len(self.robot.goals)), None]
        pairs = list(zip(self.ways, left, strict=True))
        return [sum(m for w, m in pairs if w.goal == g) / sum(left) for g in goals]

    def fact_posterior(self, observed: Sequence[str]) -> float:
        """P(FACT | o)."""
        left = self.left(observed)
        held = [
            m * (self.robot.fact if way.fact is None else way.fact)
            for way, m in zip(self.ways, left, strict=True)
        ]
        return sum(held) / sum(left)

    def cross_entropy(self, observed: Sequence[str]) -> float:
        """H(o)."""
        pairs = list(zip(self.ways, self.left(observed), strict=True))
        return -math.log(sum(m for w, m in pairs if w.is_robot) / sum(m for _, m in pairs))

    def doubt(self, observed: Sequence[str]) -> float:
        """D(o)."""
        if self.listener.kind == 'planner':
            return self.cross_entropy(observed)
        pairs = list(zip(self.ways, self.left(observed), strict=True))
        everything = sum(m for _, m in pairs)
        goal = sum(m for w, m in pairs if w.goal == 0)
        foreseen = sum(m for w, m in pairs if w.goal == 0 and w.fact is not None)
        belief = sum(m for w, m in pairs if w.goal == 0 and w.fact is self.robot.beliefs[0][1])
        way = sum(m for w, m in pairs if w.is_robot)
        facts = max(belief / foreseen, 0.01)
        return (
            -math.log(goal / everything)
            - self.listener.interest_in_facts * math.log(facts)
            - self.listener.interest_in_way * math.log(way / belief)
        )

    def _means(self) -> set[str]:
        return set(self.told) - set().union(*(self.ends(goal) for goal in self.open))

    def _spoils(self, positions: list[int], heard: Sequence[str]) -> bool:
        """Whether a means is said for no surprise, or an end is left that tells more."""
        spoken = {*heard, *(self.sentences[i] for i in positions)}
        if self.listener.kind == 'planner' or not self._means() & (spoken - set(heard)):
            return False
        own = [(w, m) for w, m in zip(self.ways, self.left(heard), strict=True) if w.goal == 0]
        foreseen = sum(m for w, m in own if w.fact is not None)
        belief = sum(m for w, m in own if w.fact is self.robot.beliefs[0][1])
        if self.listener.interest_in_way == 0 and belief / foreseen > 0.5 + 1e-9:
            return True
        now = self.goal_posterior(sorted(spoken))[0]
        rest = set(self.told) - self._means() - spoken
        least = self.listener.min_gain or 0.0
        return any(math.log(self.goal_posterior([*spoken, end])[0] / now) > least for end in rest)

    def _single_best(
        self, left: Sequence[str], last: dict[str, int], before: float
    ) -> tuple[list[int], float]:
        gains = [(before - self.doubt([s]), [last[s]]) for s in left]
        most = max(gain for gain, _ in gains)
        gain, positions = max(
            (item for item in gains if item[0] >= most - 1e-9), key=lambda item: item[1]
        )
        return positions, gain

    def answer(self, n: int, heard: Sequence[str] = ()) -> tuple[list[int], float]:
        """The positions said, and their gain, by looking at every set of sentences."""
        last = {s: max(i for i, t in enumerate(self.sentences) if t == s) for s in self.told}
        left = [s for s in self.told if s not in heard]
        before = self.doubt(heard)
        n = min(n, len(left))
        sizes = range(1, n + 1) if self.listener.min_gain is not None else [n]
        best: list[tuple[float, list[int]]] = []
        for size in sizes:
            every = []
            for chosen in itertools.combinations(left, size):
                gain = before - self.doubt([*heard, *chosen])
                every.append((gain, sorted(last[s] for s in chosen)))
            if not every:
                return [], 0.0
            most = max(gain for gain, _ in every)
            tied = [(g, p) for g, p in every if g >= most - 1e-9]
            best.append(max(tied, key=lambda item: item[1][::-1]))
            if self._spoils(best[-1][1], heard):
                ends = {last[s] for s in set(left) - self._means()}
                size = min(size, len(ends))
                every = [
                    (before - self.doubt([*heard, *(self.sentences[i] for i in c)]), sorted(c))
                    for c in itertools.combinations(ends, size)
                ]
                most = max(gain for gain, _ in every)
                tied = [(g, p) for g, p in every if g >= most - 1e-9]
                best[-1] = max(tied, key=lambda item: item[1][::-1])
        if not best:
            return [], 0.0
        largest = max(gain for gain, _ in best)
        margin = self.listener.min_gain or 0.0
        gain, positions = next(b for b in best if b[0] >= largest - margin - 1e-9)
        if not heard and not positions:
            return self._single_best(left, last, before)
        if heard and largest <= max(margin, 1e-9):
            return [], 0.0
        return positions, gain
