"""Whole tasks as they are told, held against the page that has them."""

from pathlib import Path
from typing import Any

import pytest
from whole_tasks import CONFIG, EXAMPLES, table, transcript

from mirror_explainer.planning import Planner

PAGE = Path(__file__).parents[2] / 'docs' / 'transcripts.md'


@pytest.mark.parametrize('name', EXAMPLES)
def test_a_task_is_told_as_documented_and_nobody_understands_less_as_it_goes_on(
    monkeypatch, name: str
):
    planned, plan = [], Planner.plan

    def counted(*given: Any, **options: Any) -> Any:
        planned.append(given)
        return plan(*given, **options)

    monkeypatch.setattr(Planner, 'plan', counted)
    monkeypatch.setattr('mirror_explainer.node.updates.SETTLING_SECONDS', 0.0)
    moments = [*transcript(CONFIG / name)]

    told = table(moments)
    assert told in PAGE.read_text(), f'docs/transcripts.md lacks the transcript:\n{told}'
    understood = [moment.understanding for moment in moments]
    assert understood == sorted(understood)
    assert len(planned) == 1, 'planned for once, before the first answer'
