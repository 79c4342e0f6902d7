"""The mirror model (Section 3 of the paper): P_R^H, the user's model of the robot, beside P_R.

P_R is deterministic: belief b_R and plan π_R. P_R^H(O, Π, B) = P(O|Π) P(Π|B) P(B) is a set
of hypotheses: foreseen ways (b, π), what the robot would do by the listener's own planning,
and unforeseen ones (g, ∗), which only have the ends of a goal (method, sections 1 and 2).
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mirror_explainer.listener.ends import Aim
from mirror_explainer.listener.goals import Part
from mirror_explainer.listener.listeners import Listener
from mirror_explainer.listener.user_model import CandidateGoal
from mirror_explainer.listener.way import Way
from mirror_explainer.planning import Belief, Plan
from mirror_explainer.selection.evidence import (
    ALL,
    BELIEF,
    FORESEEN,
    GOAL,
    Doubt,
    Evidence,
    Floats,
)

Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """A way that the robot may be going: a belief with a plan, or an unforeseen way with an aim.

    `goal` is an index into the model's goals, of an aim that lacks a part the goal it is
    part of. `ratios` is the row of the model's ratios that it has. `probability` is as
    P(b) P(π|b), renormalised, so that all hypotheses sum to 1.
    """

    goal: int
    probability: float
    ratios: int
    plan: Plan | None = None
    belief: Belief | None = None
    aim: Aim | None = None

    @property
    def of_part(self) -> bool:
        """Whether it is for a goal that lacks a part of a candidate."""
        return self.aim is not None and self.aim.lacking is not None


@dataclass(frozen=True)
class MirrorModel:
    """P_R^H for one listener, as hypotheses, of which `robot` is (b_R, π_R).

    `facts` are the uncertain ones with P(fact). `ratios`, shape (R, T), are the different
    likelihood ratios P(s|way) / P(s|π_R) of the T different `told` sentences of π_R.
    `planned` and `unsolvable` are shares of P(B): planned for or proved unsolvable, and the
    latter alone; `covered` is the share that was enumerated. `plans_cut` counts the beliefs
    of which not all plans asked for are known, `cut_by_time` those of them that time cut.
    """

    listener: Listener
    goals: tuple[CandidateGoal, ...]
    facts: Mapping[str, float]
    way: Way
    told: tuple[str, ...]
    hypotheses: tuple[Hypothesis, ...]
    robot: int
    ratios: Floats
    covered: float = 1.0
    planned: float = 1.0
    unsolvable: float = 0.0
    plans_cut: int = 0
    cut_by_time: int = 0

    @property
    def plan(self) -> Plan:
        """π_R."""
        return self.way.plan

    @property
    def sentences(self) -> tuple[str, ...]:
        """The sentence of each position of π_R."""
        return self.way.sentences

    @property
    def true_goal(self) -> int:
        """The index of G_R."""
        return self.hypotheses[self.robot].goal

    @property
    def robot_goal(self) -> CandidateGoal:
        """G_R."""
        return self.goals[self.true_goal]

    @property
    def robot_belief(self) -> Belief:
        """b_R."""
        belief = self.hypotheses[self.robot].belief
        assert belief is not None
        return belief

    @property
    def larger(self) -> list[bool]:
        """For each goal, whether it has all that G_R has the robot bring about, and more."""
        own = set(self.way.aims[self.true_goal][0].parts)
        return [own < set(whole.parts) for whole, *_ in self.way.aims]

    @property
    def complete(self) -> bool:
        """Whether all of P(B) was planned for, and time cut no search for further plans."""
        return self.planned == 1.0 and not self.cut_by_time

    @property
    def doubt_measure(self) -> Doubt:
        """D, as this listener has it."""
        listener = self.listener
        return Doubt(
            listener.interest_in_facts, listener.interest_in_way, whole=not listener.is_open
        )

    @cached_property
    def prior(self) -> Floats:
        """The probability of each hypothesis, shape (K,)."""
        return np.array([hypothesis.probability for hypothesis in self.hypotheses])

    @cached_property
    def _row(self) -> Ints:
        """The row of ratios of each hypothesis, shape (K,)."""
        return np.array([hypothesis.ratios for hypothesis in self.hypotheses], dtype=np.int64)

    @cached_property
    def _counted(self) -> NDArray[np.bool_]:
        """What each hypothesis counts as (the columns of Evidence.weight), shape (K, 4)."""
        robot = self.robot_belief
        own = [
            (
                h.goal == robot.goal and not h.of_part,
                h.belief is not None,
                h.belief == robot,
            )
            for h in self.hypotheses
        ]
        goal, foreseen, belief = np.array(own, dtype=bool).T
        return np.stack([np.ones_like(goal), goal, goal & foreseen, belief], axis=1)

    @cached_property
    def _goal_of(self) -> Ints:
        """The goal of each hypothesis, shape (K,): one more than there are for a part of one."""
        partial = len(self.goals)
        return np.array(
            [partial if h.of_part else h.goal for h in self.hypotheses], dtype=np.int64
        )

    @cached_property
    def places(self) -> tuple[tuple[int, ...], ...]:
        """The plan positions of each told sentence, ascending."""
        found: dict[str, list[int]] = {sentence: [] for sentence in self.told}
        for position, sentence in enumerate(self.sentences):
            found[sentence].append(position)
        return tuple(tuple(positions) for positions in found.values())

    def columns(self, positions: Sequence[int]) -> list[int]:
        """The columns of the different sentences said at these positions."""
        column = {sentence: index for index, sentence in enumerate(self.told)}
        return sorted({column[self.sentences[position]] for position in positions})

    def joint(self, positions: Sequence[int] = ()) -> Floats:
        """P(hypothesis, o) as a multiple of P(o|π_R), for the sentences o said, shape (K,)."""
        fit = self.ratios[:, self.columns(positions)].prod(axis=1)
        joint: Floats = self.prior * fit[self._row]
        return joint

    def posterior(self, positions: Sequence[int] = ()) -> Floats:
        """P(hypothesis | o), shape (K,)."""
        joint = self.joint(positions)
        posterior: Floats = joint / joint.sum()
        return posterior

    def cross_entropy(self, positions: Sequence[int] = ()) -> float:
        """H(P_R, P_R^H | o) = −log P(π_R, b_R | o) in nats (Eq. 1); 0 is full understanding."""
        return max(0.0, -math.log(self.posterior(positions)[self.robot]))

    def doubt(self, positions: Sequence[int] = ()) -> float:
        """D(o) in nats: what this listener does not know, once these positions were said."""
        masses = self.joint(positions) @ self._counted
        return float(self.doubt_measure.of(masses, self.prior[self.robot]))

    def information_gain(self, positions: Sequence[int], said: Sequence[int] = ()) -> float:
        """D(said) − D(said, o) in nats; for the paper's listener Eq. 2."""
        return self.doubt(said) - self.doubt([*said, *positions])

    def goal_posterior(self, positions: Sequence[int] = ()) -> Floats:
        """P(G = g | o) of each goal, and of all that lack a part of one; sums to 1."""
        goals = len(self.goals) + 1
        return np.bincount(self._goal_of, self.posterior(positions), goals).astype(np.float64)

    def understanding(self, positions: Sequence[int] = ()) -> float:
        """P(G = G_R | o): how sure the user is of the robot's true goal, in [0, 1]."""
        return min(1.0, float(self.goal_posterior(positions)[self.true_goal]))

    def fact_posterior(self, positions: Sequence[int] = ()) -> dict[str, float]:
        """P(fact | o) of each uncertain fact; in an unforeseen way facts keep their prior."""
        weights = self.posterior(positions)
        of_belief: Counter[frozenset[str]] = Counter()
        foreseen = 0.0
        for hypothesis, weight in zip(self.hypotheses, weights.tolist(), strict=True):
            if hypothesis.belief is not None:
                of_belief[hypothesis.belief.true_facts] += weight
                foreseen += weight
        return {
            fact: min(
                1.0,
                sum(weight for facts, weight in of_belief.items() if fact in facts)
                + max(0.0, 1.0 - foreseen) * probability,
            )
            for fact, probability in self.facts.items()
        }

    def unmentioned(self, positions: Sequence[int]) -> tuple[Part, ...]:
        """The parts of G_R that the robot has yet to bring about and no said sentence achieves."""
        said = {self.sentences[position] for position in positions}
        own = self.way.aims[self.true_goal][0]
        return tuple(
            part
            for part in own.parts
            if part not in own.ends or self.sentences[own.ends[part]] not in said
        )

    def single_gains(self, said: Sequence[int] = ()) -> list[float]:
        """The nats that the sentence of each plan position would tell by itself, 0 if said."""
        evidence = self.evidence(said)
        doubts = evidence.doubt.of(evidence.ratio.T @ evidence.weight, evidence.robot)
        gains = dict.fromkeys(self.sentences, 0.0)
        for places, doubt in zip(evidence.places, doubts.tolist(), strict=True):
            gains[self.sentences[places[0]]] = evidence.doubt_before - doubt
        return [gains[sentence] for sentence in self.sentences]

    def evidence(self, said: Sequence[int] = ()) -> Evidence:
        """Return what is left to say, given the positions whose sentences were said.

        A sentence that was said is not said again, wherever it stands.
        """
        heard = set(self.columns(said))
        left = [column for column in range(len(self.told)) if column not in heard]
        joint = self.joint(said)
        weight = np.stack(
            [
                np.bincount(self._row, joint * self._counted[:, column], len(self.ratios))
                for column in (ALL, GOAL, FORESEEN, BELIEF)
            ],
            axis=1,
        )
        possible = weight[:, ALL] > 0
        ratio = self.ratios  # taken as it is where that will do: it may be large
        if heard or not possible.all():
            ratio = np.compress(possible, ratio.T[left], axis=1).T
        return Evidence(
            ratio,
            weight[possible] / joint.sum(),
            float(joint[self.robot] / joint.sum()),
            tuple(self.places[column] for column in left),
            self.doubt_measure,
            frozenset(index for index, column in enumerate(left) if column not in self._ends),
            self.listener.min_gain,
        )

    @cached_property
    def _ends(self) -> frozenset[int]:
        """The columns of the sentences that are an end of some candidate; all to the planner's."""
        if not self.listener.is_open:
            return frozenset(range(len(self.told)))
        ends = [position for whole, *_ in self.way.aims for position in whole.positions]
        return frozenset(self.columns(ends))
