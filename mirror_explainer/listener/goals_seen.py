"""The goals that a robot was seen to have, and how often: a file that people can read and edit.

goals_seen:
(and (delivered insulin ward_1b) (docked)): 12

"""

from collections.abc import Mapping

import yaml

from mirror_explainer.errors import InputError
from mirror_explainer.text_files import read_text

# With more goals than this the rarest are dropped.
MOST_GOALS = 300
_KEY = 'goals_seen'


def read_goals_seen(path: str) -> dict[str, int]:
    """Return the goals in a file with their counts; raises InputError.

    A file that has no counts, but a goal a line, is taken as well.
    """
    text = read_text(path)
    lines = [line.strip() for line in text.split('\n')]
    lines = [line for line in lines if line and not line.startswith(('#', ';'))]
    if lines and all(line.startswith('(') and line.endswith(')') for line in lines):
        return {line: lines.count(line) for line in lines}
    try:
        data = yaml.safe_load(text)
    except yaml.YAMLError as error:
        mark = getattr(error, 'problem_mark', None)
        raise InputError(path, f'this is no YAML: {error}', mark and mark.line + 1) from error
    counts = data.get(_KEY) if isinstance(data, dict) and len(data) == 1 else None
    if not isinstance(counts, dict) or not all(map(_is_count, counts.items())):
        raise InputError(
            path,
            f'this has no "{_KEY}" with goals and whole numbers',
            cure='Write one goal a line, or remove the file and let the node count anew.',
        )
    return dict(counts)


def goals_seen_text(counts: Mapping[str, int]) -> str:
    """Return the file's text, the most frequent goals first, bounded in number."""
    often = sorted(counts.items(), key=lambda item: -item[1])[:MOST_GOALS]
    head = '# Goals that the robot had, and how often. The node counts; you may edit.\n'
    return head + yaml.safe_dump({_KEY: dict(often)}, sort_keys=False, allow_unicode=True)


def _is_count(item: tuple[object, object]) -> bool:
    goal, count = item
    return isinstance(goal, str) and isinstance(count, int) and not isinstance(count, bool)
