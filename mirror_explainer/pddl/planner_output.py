"""The plan in what a planner, or `ros2 topic echo`, prints: banners and counts left out.

Only where the text says that it is such output, so that no broken plan passes for one.
"""

import re
from collections.abc import Iterable, Mapping
from typing import Any

import yaml

# What planners print around their plans: Fast Downward, FF and Metric-FF, POPF and OPTIC, TFD,
# LPG, ENHSP.
_BANNER = re.compile(
    r'solution found|found (?:a |legal |new )?plan|plan found|found plan|problem solved'
    r'|solution with original makespan|solution number|plan computed|rewriting plan',
    re.IGNORECASE,
)
_NUMBER = r'\d+(?:\.\d*)?(?:e[+-]?\d+)?'
_LISP = r'\(\s*[^\s();:\[\]]+(?:\s+[^\s();:\[\]]+)*\s*\)'
# "0.000: (move a b) [1.0]" and "(move a b)", with what may stand behind it.
_WRITTEN = re.compile(rf'(?:{_NUMBER}\s*:\s*)?{_LISP}(?:\s*\[[^\]]*\])?(?:\s*;.*)?', re.I)
# "step 0: MOVE A B", and the lines after it, "1: MOVE A B".
_NUMBERED = re.compile(r'(?:step\s+)?\d+\s*:(?:\s+[^\s();:\[\]]+)+', re.I)
# "move a b (1)", each with its cost, perhaps after "[t=0.01s, 1000 KB] ".
_PRICED = re.compile(r'(?:\[t=[^\]]*\]\s*)?([^\s();:\[\]]+(?:\s+[^\s();:\[\]]+)*) \(\d+\)')


def plan_in(text: str) -> str | None:
    """Return the last plan in a planner's output, or in a message as YAML; None if it is neither.

    The lines of the plan in an output stay where they are.
    """
    start = text.lstrip()[:100].removeprefix('---').lstrip()
    if re.match(r'(?:data|plan|items):', start):
        return _in_message(text)
    return _in_output(text)


def _in_output(text: str) -> str | None:
    lines = text.split('\n')
    banners = [number for number, line in enumerate(lines) if _BANNER.search(line)]
    if not banners:
        return None
    kept = [_plan_line(line) for line in lines[banners[0] :]]
    # Of several plans, each better than the one before, the last counts.
    last = max((number for number, line in enumerate(kept) if line), default=None)
    if last is None:
        return None
    first = last
    while first > 0 and (kept[first - 1] or not lines[banners[0] + first - 1].strip()):
        first -= 1
    block = [line if first <= number <= last else '' for number, line in enumerate(kept)]
    return '\n'.join([''] * banners[0] + block)


def _plan_line(line: str) -> str:
    """Return a line of a plan as plans are written, '' for another line."""
    line = line.strip()
    if priced := _PRICED.fullmatch(line):
        return f'({priced[1]})'
    return line if _WRITTEN.fullmatch(line) or _NUMBERED.fullmatch(line) else ''


def _in_message(text: str) -> str | None:
    """Return the plan in a String, or a plan of PlanSys2, as `ros2 topic echo` prints it."""
    try:
        message = next(iter(yaml.safe_load_all(text)), None)
    except (yaml.YAMLError, ValueError):
        return None
    if isinstance(message, Mapping) and isinstance(message.get('data'), str):
        return str(message['data'])
    items = message
    while isinstance(items, Mapping):
        items = items.get('items', items.get('plan'))
    if isinstance(items, list) and items and all(isinstance(item, Mapping) for item in items):
        return _listed(items)
    return None


def _listed(items: Iterable[Mapping[str, Any]]) -> str:
    lines = []
    for item in items:
        time, duration = item.get('time'), item.get('duration')
        start = f'{time}: ' if isinstance(time, int | float) else ''
        lasting = f' [{duration}]' if start and isinstance(duration, int | float) else ''
        lines.append(f'{start}{item.get("action", "")}{lasting}')
    return '\n'.join(lines)
