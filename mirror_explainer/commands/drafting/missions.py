"""What a robot without PDDL may be told to do: lists of tasks in a file, one a line."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

from mirror_explainer.errors import InputError
from mirror_explainer.listener.goals_seen import read_goals_seen
from mirror_explainer.listener.robot_tasks import done_text, named_tasks, task_name
from mirror_explainer.text_files import read_text

_EXAMPLE = 'Write a list a line: "serve tea: drive to the kitchen, boil water, bring the tea".'


@dataclass(frozen=True)
class Mission:
    """Tasks by their names in PDDL, in order, what they are for ('' if not told), how often.

    The names are in lower case; `written` has them as the file does, "remind_Ms_Ito".
    """

    written: tuple[str, ...]
    name: str
    count: int

    @property
    def tasks(self) -> tuple[str, ...]:
        """The names."""
        return tuple(task.lower() for task in self.written)

    @property
    def parts(self) -> tuple[str, ...]:
        """The parts of the goal that all of them are done."""
        return tuple(map(done_text, self.tasks))


def read_missions(path: str) -> list[Mission]:
    """Return the lists in a file; the same ones count once more. Raises InputError.

    A line is a name and a colon, if it has one, and tasks with commas between; one that begins
    with # is a comment. A file of goals seen, as the node counts them, is taken as well.
    """
    text = read_text(path)
    found = _of_goals_seen(path) if named_tasks(text) else list(_of_lines(text, path))
    if not found:
        raise InputError(path, 'there is no list of tasks in it', cure=_EXAMPLE)
    names: dict[tuple[str, ...], str] = {}
    counts: Counter[tuple[str, ...]] = Counter()
    same: dict[frozenset[str], tuple[str, ...]] = {}
    for each in found:
        tasks = same.setdefault(frozenset(each.tasks), each.written)
        names[tasks] = names.get(tasks) or each.name
        counts[tasks] += each.count
    return [Mission(tasks, names[tasks], count) for tasks, count in counts.items()]


def _of_lines(text: str, path: str) -> Iterator[Mission]:
    for number, line in enumerate(text.splitlines(), start=1):
        line = line.strip()
        if not line or line.startswith('#'):
            continue
        name, _, tasks = line.partition(':') if ':' in line else ('', '', line)
        told = [task.strip() for task in tasks.split(',') if task.strip()]
        if not told:
            raise InputError(path, f'"{line}" names no task', number, cure=_EXAMPLE)
        try:
            yield Mission(tuple(map(task_name, told)), name.strip(), 1)
        except InputError as error:
            raise InputError(path, error.reason, number, cure=_EXAMPLE) from error


def _of_goals_seen(path: str) -> list[Mission]:
    counts = read_goals_seen(path).counts
    lists = {goal: tuple(named_tasks(goal)) for goal in counts}
    return [Mission(lists[goal], '', counts[goal]) for goal in counts if lists[goal]]
