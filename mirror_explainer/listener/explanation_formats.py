"""An explanation in other forms: its hypotheses as plain values for JSON, its goals as HTML."""

from collections.abc import Iterator, Mapping, Sequence
from html import escape
from typing import Any

from mirror_explainer.listener.mirror_model import MirrorModel

_GOALS_SHOWN = 6


def hypothesis_rows(model: MirrorModel) -> Iterator[dict[str, Any]]:
    """Yield each hypothesis as plain values: its plan if it is foreseen, else its parts."""
    for index, hypothesis in enumerate(model.hypotheses):
        belief, plan, aim = hypothesis.belief, hypothesis.plan, hypothesis.aim
        row: dict[str, Any] = {
            'goal': None if hypothesis.of_part else model.goals[hypothesis.goal].name,
            'true_facts': None,
            'plan': list(plan.actions) if plan else None,
            'cost': plan.cost if plan else None,
            'probability': hypothesis.probability,
            'robot': index == model.robot,
        }
        if belief is not None:
            row['true_facts'] = [f for f in model.facts if f in belief.true_facts]
        if aim is not None:
            row |= {'parts': [str(part) for part in aim.parts], 'ends': aim.positions}
        yield row


def as_html(spoken: str, goals: Sequence[Mapping[str, Any]], in_words: Mapping[str, str]) -> str:
    """Return what is said, and the likeliest goals with prior and posterior, for a notebook.

    `in_words` has what goals without a name are called.
    """
    said = '<br>'.join(escape(line) for line in spoken.split('\n'))
    rows = ''.join(
        f'<tr><td>{escape(in_words.get(goal["name"], goal["name"] or "a part of these"))}</td>'
        f'<td>{goal["prior"]:.0%}</td><td>{goal["posterior"]:.0%}</td></tr>'
        for goal in sorted(goals, key=lambda goal: -goal['posterior'])[:_GOALS_SHOWN]
    )
    head = '<tr><th>goal</th><th>before</th><th>after</th></tr>'
    return f'<blockquote>{said}</blockquote><table>{head}{rows}</table>'
