"""The problem as a robot would publish it next: its own text, with the state as it now is."""

import re

from mirror_explainer.pddl.states import State
from mirror_explainer.pddl.text.sections import section


def with_state(problem: str, state: State) -> str:
    """Return the problem's text with this state of it in place of its initial one."""
    init = section(problem, ':init') or section(problem, ':goal')
    assert init is not None  # a problem without a goal is not read
    start, end = init.start, init.end if init.keyword == ':init' else init.start
    numbers = {atom: f'{float(value):.6f}' for atom, value in state.numbers.items()}
    if re.search(r'\(\s*total-cost\s*\)', problem[start:end], re.IGNORECASE):
        numbers['(total-cost)'] = '0'  # what is left to do has cost nothing so far
    given = [f'(= {atom} {number})' for atom, number in sorted(numbers.items())]
    said = '\n    '.join([*sorted(state.facts), *given])
    return f'{problem[:start]}(:init\n    {said})\n  {problem[end:].lstrip()}'
