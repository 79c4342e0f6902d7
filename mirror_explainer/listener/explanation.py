"""What is said, and what it does to the listener's beliefs: an answer, as values and as JSON."""

from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import Any

from mirror_explainer.listener.explanation_formats import as_html, hypothesis_rows
from mirror_explainer.listener.mirror_model import MirrorModel
from mirror_explainer.listener.preparation import Preparation
from mirror_explainer.listener.spoken_answer import SpokenAnswer
from mirror_explainer.pddl.progress import StepStatus
from mirror_explainer.pddl.situation import FIRST
from mirror_explainer.selection.baselines import ORDERS
from mirror_explainer.selection.choice import Selection, baseline
from mirror_explainer.settings import Question

# The keys of an explanation as JSON, each also an attribute.
_KEYS = (
    'strategy', 'n', 'sentences', 'spoken', 'positions', 'actions', 'information_gain',
    'doubt_before', 'doubt_after', 'cross_entropy_before', 'cross_entropy_after',
    'understanding_before', 'understanding', 'true_goal', 'unmentioned', 'in_words', 'optimal',
    'gap', 'complete', 'planned', 'covered_mass', 'unsolvable_mass', 'unknown_mass', 'plans_cut',
    'listener', 'goals', 'facts', 'baselines', 'plan', 'episode',
)  # fmt: skip


@dataclass(frozen=True)
class Explanation:
    """What to say, and what it does to the listener's beliefs.

    Its attributes are the keys of the JSON (docs). `selection` has the plan positions in plan
    order (from 0), the information gain and its gap (nats). `known` are positions whose
    sentences the listener knows: they were said before, are done where the past is not
    told, or failed or were left out for a reason, of which each answer tells. All quantities
    are given these.
    """

    preparation: Preparation
    model: MirrorModel
    question: Question
    selection: Selection
    known: tuple[int, ...]
    seconds_selecting: float = 0.0
    opening: str = ''

    @property
    def strategy(self) -> str:
        """How it was chosen what to say."""
        return self.question.strategy

    @property
    def n(self) -> int:
        """How many sentences are said."""
        return len(self.positions)

    @property
    def positions(self) -> list[int]:
        """The plan positions that are said, ascending."""
        return list(self.selection.positions)

    @property
    def sentences(self) -> tuple[str, ...]:
        """The sentences to say, in plan order."""
        return tuple(self.model.sentences[position] for position in self.positions)

    @property
    def actions(self) -> list[str]:
        """The ground actions that are said."""
        return [self.model.plan.actions[position] for position in self.positions]

    @cached_property
    def spoken(self) -> str:
        """The answer as a person hears it: like steps in one sentence, a sentence a line."""
        return SpokenAnswer(
            self.preparation,
            self.positions,
            self.known,
            self.unsaid_ends,
            self.question.n,
            self.opening,
        ).text

    @property
    def _heard(self) -> list[int]:
        return [*self.known, *self.positions]

    @property
    def information_gain(self) -> float:
        """How much doubt was taken away, in nats."""
        return self.selection.information_gain

    @cached_property
    def doubt_before(self) -> float:
        """D(known) in nats."""
        return self.model.doubt(self.known)

    @cached_property
    def doubt_after(self) -> float:
        """D(known, o) in nats."""
        return self.model.doubt(self._heard)

    @cached_property
    def cross_entropy_before(self) -> float:
        """H(known) in nats (Eq. 1)."""
        return self.model.cross_entropy(self.known)

    @cached_property
    def cross_entropy_after(self) -> float:
        """H(known, o) in nats."""
        return self.model.cross_entropy(self._heard)

    @cached_property
    def understanding_before(self) -> float:
        """P(G = G_R | known), in [0, 1]."""
        return self.model.understanding(self.known)

    @cached_property
    def understanding(self) -> float:
        """P(G = G_R | known, o), in [0, 1]."""
        return self.model.understanding(self._heard)

    @property
    def true_goal(self) -> str:
        """The name of G_R."""
        return self.model.robot_goal.name

    @property
    def unmentioned(self) -> list[str]:
        """The parts of the robot's goal that no said sentence achieves, as PDDL."""
        return [str(part) for part in self.model.unmentioned(self._heard)]

    @cached_property
    def in_words(self) -> dict[str, str]:
        """What goals without a name, and what is unmentioned, are called, by their PDDL.

        Of what can be called so: by what is to be done.
        """
        parts = {
            goal.goal: [str(part) for part in parts]
            for goal, parts in zip(self.model.goals, self.preparation.prior.parts, strict=True)
            if goal.name == goal.goal
        } | {part: [part] for part in self.unmentioned}
        called = {text: self.preparation.goal_names.of(of) for text, of in parts.items()}
        return {text: words for text, words in called.items() if words}

    @cached_property
    def unsaid_ends(self) -> list[int]:
        """The plan positions that achieve what is unmentioned, ascending."""
        ends = self.model.way.aims[self.model.true_goal][0].ends
        unmentioned = self.model.unmentioned(self._heard)
        return sorted({ends[part] for part in unmentioned if part in ends})

    @property
    def optimal(self) -> bool:
        """Whether nothing of this size tells more."""
        return self.selection.optimal

    @property
    def gap(self) -> float:
        """How many nats more the best choice may tell."""
        return self.selection.gap

    @property
    def complete(self) -> bool:
        """Whether all of P(B) was planned for, and all plans asked for were looked for."""
        return self.model.complete

    @property
    def planned(self) -> float:
        """The share of P(B) that is planned for or proved unsolvable."""
        return self.model.planned

    @property
    def covered_mass(self) -> float:
        """The share of P(B) that was enumerated."""
        return self.model.covered

    @property
    def unsolvable_mass(self) -> float:
        """The share of P(B) that is proved to have no plan."""
        return self.model.unsolvable

    @property
    def unknown_mass(self) -> float:
        """The share of P(B) that is not planned for."""
        return 1.0 - self.planned

    @property
    def plans_cut(self) -> int:
        """The number of beliefs of which not all plans asked for are known."""
        return self.model.plans_cut

    @property
    def listener(self) -> dict[str, Any]:
        """The listener's kind and numbers, as in the user model."""
        return asdict(self.model.listener)

    @cached_property
    def goals(self) -> list[dict[str, Any]]:
        """Each candidate's name, prior and posterior; last, nameless, those that lack a part."""
        before = self.model.goal_posterior(self.known).tolist()
        after = self.model.goal_posterior(self._heard).tolist()
        names = [*(goal.name for goal in self.model.goals), None]
        return [
            {'name': name, 'prior': prior, 'posterior': posterior}
            for name, prior, posterior in zip(names, before, after, strict=True)
        ]

    @cached_property
    def facts(self) -> list[dict[str, Any]]:
        """Each uncertain fact with prior, posterior, and whether it is true."""
        before = self.model.fact_posterior(self.known)
        after = self.model.fact_posterior(self._heard)
        true = self.model.robot_belief.true_facts
        return [
            {'fact': f, 'prior': before[f], 'posterior': after[f], 'true': f in true}
            for f in before
        ]

    @cached_property
    def baselines(self) -> list[dict[str, Any]]:
        """What the first and the last steps, as many as are said, would have told instead."""
        evidence = self.model.evidence(self.known)
        told = []
        for strategy in ORDERS:
            positions = baseline(evidence, strategy, self.n).positions
            understanding = self.model.understanding([*self.known, *positions])
            told.append(
                {
                    'strategy': strategy,
                    'positions': list(positions),
                    'understanding': understanding,
                }
            )
        return told

    @cached_property
    def plan(self) -> list[dict[str, Any]]:
        """Each step of the plan: its sentence, now and in each status, and what it tells alone."""
        rows = zip(
            self.model.plan.actions,
            self.preparation.statuses,
            self.model.single_gains(self.known),
            strict=True,
        )
        told = []
        for i, (action, status, gain) in enumerate(rows):
            said = self.preparation.sentences.said
            tenses = {str(each): said(action, each) for each in StepStatus}
            told.append(
                {
                    'position': i,
                    'action': action,
                    'sentence': tenses[status],
                    'status': str(status),
                    'tenses': tenses,
                    'information_gain': gain,
                }
            )
        return told

    @property
    def episode(self) -> dict[str, Any]:
        """Which of the robot's tasks this is about, since when, and why it began."""
        situation = self.preparation.situation
        began = situation.began if situation else None
        return {
            'number': situation.number if situation else 1,
            'began': began.isoformat(timespec='seconds') if began else None,
            'reason': situation.reason if situation else FIRST,
        }

    @property
    def hypotheses(self) -> list[dict[str, Any]]:
        """Each foreseen way, and each unforeseen one; their probabilities sum to 1."""
        return [*hypothesis_rows(self.model)]

    def as_dict(self, hypotheses: bool = True) -> dict[str, Any]:
        """Return the explanation as plain values, ready for JSON."""
        told = {key: getattr(self, key) for key in _KEYS}
        told['sentences'] = list(self.sentences)
        if hypotheses:
            told['hypotheses'] = self.hypotheses
        seconds = replace(self.preparation.seconds, selection=self.seconds_selecting)
        told['seconds'] = asdict(seconds)
        told['planner_calls'] = self.preparation.planner_calls
        return told

    def __repr__(self) -> str:
        return '\n'.join(
            [
                f'Explanation of {self.n} of {len(self.model.sentences)} steps:',
                *(f'  {line}' for line in self.spoken.split('\n')),
                f'  understood: {self.understanding_before:.0%} before, {self.understanding:.0%} '
                f'after ("{self.in_words.get(self.true_goal, self.true_goal)}")',
            ]
        )

    def _repr_html_(self) -> str:
        return as_html(self.spoken, self.goals, self.in_words)
