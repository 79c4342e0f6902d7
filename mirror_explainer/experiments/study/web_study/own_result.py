"""A participant's own result: how soon they were sure, as words, picture and table; a review."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mirror_explainer.experiments.study.design import DONT_KNOW, Answer
from mirror_explainer.experiments.study.web_study.design import without_listener

WIDTH, ROW = 640, 56
_LEFT, _RIGHT, _TOP = 160, 610, 12
DRAWN = ('informative', 'decreasing', 'increasing')


@dataclass(frozen=True)
class Encountered:
    """One scenario: its goal and strategy, and the answers step by step as marks."""

    scenario: str
    goal: str
    strategy: str
    marks: tuple[str, ...]

    @property
    def sure(self) -> int | None:
        """The step from which on all answers are right; None: never."""
        wrong = [i for i, mark in enumerate(self.marks, start=1) if mark != 'right']
        last = max(wrong, default=0)
        return last + 1 if last < len(self.marks) else None


def encountered(answers: Sequence[Answer]) -> list[Encountered]:
    """Return a participant's scenarios, in the order of the answers."""
    of: dict[str, list[Answer]] = {}
    for answer in answers:
        of.setdefault(answer.scenario, []).append(answer)
    return [
        Encountered(
            name, given[0].goal, without_listener(given[0].strategy), tuple(map(_mark, given))
        )
        for name, given in of.items()
    ]


@dataclass(frozen=True)
class Row:
    """A strategy: after how many sentences somebody was sure, on average, and listeners are.

    Somebody was sure in `sure` of `met` scenarios, and `mean` is over these. `mean` and
    `simulated` are None where there is nothing to average. The rest is the picture: `y` is
    the row's middle, and the other numbers are x. Each scenario is a dot, a hollow one at the
    plan's end where somebody never was sure: x, y, and whether it is hollow.
    """

    strategy: str
    met: int
    sure: int
    mean: float | None
    simulated: float | None
    y: float
    bar: float
    line: float | None
    dots: tuple[tuple[float, float, bool], ...]


@dataclass(frozen=True)
class Chart:
    """The picture: a row a strategy, so that none hides another."""

    rows: tuple[Row, ...]
    ticks: tuple[tuple[float, int], ...]
    left: int = _LEFT
    right: int = _RIGHT
    width: int = WIDTH

    @property
    def bottom(self) -> int:
        """Where the axis is."""
        return _TOP + ROW * len(self.rows)

    @property
    def height(self) -> int:
        """The whole height, with the axis' words."""
        return self.bottom + 62


def chart(of: Sequence[Encountered], simulated: Mapping[str, float]) -> Chart:
    """Return the picture of somebody's encounters beside that of simulated listeners."""
    most = max((len(each.marks) for each in of), default=1) + 1

    def x(steps: float) -> float:
        return round(_LEFT + (_RIGHT - _LEFT) * steps / most, 1)

    rows = []
    for index, strategy in enumerate(DRAWN):
        met = [each for each in of if each.strategy == strategy]
        sure = [each.sure for each in met if each.sure is not None]
        mean = sum(sure) / len(sure) if sure else None
        usual = simulated.get(strategy)
        y = _TOP + ROW * (index + 0.5)
        # Dots at one number stand side by side, above one another.
        places = sorted((each.sure or len(each.marks), each.sure is None) for each in met)
        steps = [step for step, _ in places]
        dots = tuple(
            (x(step), round(y + 7 - 9 * steps[:i].count(step), 1), never)
            for i, (step, never) in enumerate(places)
        )
        line = None if usual is None else x(usual)
        bar = x(mean or 0) - _LEFT
        rows.append(Row(strategy, len(met), len(sure), mean, usual, y, bar, line, dots))
    every = 1 if most <= 12 else 5
    return Chart(tuple(rows), tuple((x(tick), tick) for tick in range(0, most, every)))


def _mark(answer: Answer) -> str:
    if answer.answer == DONT_KNOW:
        return 'unknown'
    return 'right' if answer.answer == answer.goal else 'wrong'
