"""An answer as a person hears it: which steps it speaks of, beside those that were chosen."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice

from mirror_explainer.listener.preparation import Preparation
from mirror_explainer.listener.sentences import Sentences
from mirror_explainer.listener.speech import reached, spoken, stuck
from mirror_explainer.pddl.progress import StepStatus


@dataclass(frozen=True)
class SpokenAnswer:
    """What is heard of an answer: what went wrong, what was chosen, and what one sees.

    All are plan positions: `positions` were chosen, the sentences of those `known` are known to
    the listener, and `unsaid_ends` achieve what no sentence tells of. `n` is how many sentences
    were asked for, `opening` what is said before all else.
    """

    preparation: Preparation
    positions: Sequence[int]
    known: Sequence[int]
    unsaid_ends: Sequence[int]
    n: int
    opening: str = ''

    @property
    def text(self) -> str:
        """The answer, a sentence a line."""
        sentences, failed = self.preparation.sentences, self._reasons(self.preparation.failed)
        lines = [self.opening, stuck(sentences, failed)]
        if not failed or self._told:
            lines.append(self._steps_spoken(sentences))
        return '\n'.join(filter(None, lines))

    def _steps_spoken(self, sentences: Sentences) -> str:
        unsaid = [p for p in self.unsaid_ends if p not in self._told]
        if all(status.is_over for status in self.preparation.statuses):
            situation = self.preparation.situation
            is_detour = situation is not None and situation.is_detour
            steps = self._steps(self._told), self._steps(unsaid)
            excuses = self._reasons(self.preparation.excused)
            return reached(sentences, *steps, excuses, is_detour)
        lines = self._lines(self._told, unsaid)
        if self._chosen or self.preparation.failed:
            return lines
        heard = {self.preparation.way.sentences[position] for position in self.known}
        is_all = heard.issuperset(self.preparation.way.sentences)
        rest = sentences.phrases.all_heard if is_all else sentences.phrases.nothing_more
        return '\n'.join(filter(None, (lines, rest)))

    @cached_property
    def _chosen(self) -> set[int]:
        """The positions that are said, and those that were left out for a reason.

        What is going on stands for what has the same sentence: "I am topping up the trough."
        says it of both times.
        """
        observations = self.preparation.way.sentences
        going_on = {observations[p]: p for p in reversed(self._going_on)}
        said = (going_on.get(observations[p], p) for p in self.positions)
        return {*said, *self.preparation.excused}

    @cached_property
    def _going_on(self) -> list[int]:
        statuses = self.preparation.statuses
        return [p for p, status in enumerate(statuses) if status is StepStatus.RUNNING]

    @cached_property
    def _told(self) -> list[int]:
        """The positions that are spoken of.

        They are what was chosen, what one sees the robot at, and an end for which a list would
        end with "one more", if it is the only one, and there are fewer than `n` without it.
        """
        told = {*self._chosen, *self._seen}
        if len(self._chosen) < self.n:
            whole = self._lines(told)
            ends = (p for p in self.unsaid_ends if p not in told)
            heard = (p for p in ends if self._lines(told, [p]) != whole)
            others = [*islice(heard, 2)]
            told |= {*others} if len(others) == 1 else set()
        return sorted(told)

    def _lines(self, told: Iterable[int], unsaid: Iterable[int] = ()) -> str:
        """Return what is said of the steps at these positions, where others are left unsaid."""
        is_stuck = bool(self.preparation.failed)
        steps = self._steps(sorted(told)), self._steps(unsaid)
        excuses = self._reasons(self.preparation.excused)
        return spoken(self.preparation.sentences, *steps, is_stuck, excuses)

    @property
    def _seen(self) -> list[int]:
        """What is going on, where nothing of it was chosen: ends, and means in the room for them.

        At most `n` ends; of means as many as sentences of what was chosen are fewer than `n`, and
        one where all that is over, or something failed.
        """
        chosen, statuses = sorted(self._chosen), self.preparation.statuses
        if not self._chosen.isdisjoint(self._going_on):
            return []
        sentences = self.preparation.sentences
        texts = {sentences.said(*self._steps([p])[0]): p for p in reversed(self._going_on)}
        seen = sorted(texts.values())
        ends = [p for p in seen if p in self.unsaid_ends][: self.n]
        lines = spoken(sentences, self._steps(chosen)).splitlines()
        is_past = all(statuses[p].is_over for p in chosen)
        least = 1 if is_past or self.preparation.failed else 0
        room = max(self.n - len(lines), least) - len(ends)
        return ends + [p for p in seen if p not in ends][: max(0, room)]

    def _steps(self, positions: Iterable[int]) -> list[tuple[str, StepStatus]]:
        """Return the steps at these positions: ground actions, and how far they are."""
        actions, statuses = self.preparation.way.plan.actions, self.preparation.statuses
        return [(actions[position], statuses[position]) for position in positions]

    def _reasons(self, positions: Iterable[int]) -> dict[str, str]:
        """Return why the steps at these positions failed or were left out, by ground action."""
        reasons, actions = self.preparation.reasons, self.preparation.way.plan.actions
        return {actions[position]: reasons.get(position, '') for position in positions}
