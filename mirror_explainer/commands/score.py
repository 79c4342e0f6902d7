"""What given sentences would tell, whoever chose them: `verbalize --score`."""

from collections.abc import Sequence
from typing import Any

from mirror_explainer.explainer import positions_of
from mirror_explainer.listener.explanation import Explanation


def scores(explanation: Explanation, sentences: Sequence[str]) -> dict[str, Any]:
    """Return what each sentence would tell alone, and all of them together.

    Given what is known before. Raises InputError for one that no step is said as.
    """
    model, known = explanation.model, explanation.known
    before = model.doubt(known)

    def told(heard: Sequence[str]) -> dict[str, float]:
        positions = [*known, *positions_of(heard, '--score', model)]
        return {
            'information_gain': before - model.doubt(positions),
            'understanding': model.understanding(positions),
        }

    alone = [{'sentence': sentence} | told([sentence]) for sentence in sentences]
    return {'sentences': alone, 'together': told(sentences)}


def score_table(score: dict[str, Any], understanding_before: float) -> str:
    """Return the scores as a text."""
    rows = [(row['sentence'], row) for row in score['sentences']]
    if len(rows) > 1:
        rows.append(('all of these', score['together']))
    lines = [f'Would tell   goal understood ({understanding_before:.0%} before)']
    for name, row in rows:
        gain = round(row['information_gain'], 2) + 0.0  # not -0.00
        lines.append(f'{gain:+5.2f} nats   {row["understanding"]:4.0%}  {name}')
    return '\n'.join(lines)
