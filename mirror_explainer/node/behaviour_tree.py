"""The tasks of a behaviour tree of py_trees: what it means to do, and how far it is with that.

Nothing of py_trees is imported: what is needed of it are names, children and statuses, and of
a node that failed the message that says why.
"""

from collections.abc import Iterator, Sequence
from typing import Any, Protocol

# What a task is called whose status has this name.
_STANDINGS = {'INVALID': 'ahead', 'RUNNING': 'running', 'SUCCESS': 'done', 'FAILURE': 'failed'}
_OVER = {'done', 'skipped'}

Kinds = type | tuple[type, ...]
# A task and how it stands; with a reason for that, if it has one.
ToldTask = tuple[str, str] | tuple[str, str, str]


class TreeNode(Protocol):
    """A `py_trees.behaviour.Behaviour`. Composites have a `current_child`, too."""

    name: str
    status: Any
    feedback_message: str

    @property
    def children(self) -> Sequence[Any]:
        """Those below it; one for a decorator, none for a leaf."""


def tree_tasks(root: TreeNode, leaves: Kinds, before: Sequence[ToldTask] = ()) -> list[ToldTask]:
    """Return the tasks that a tree means to do, in order, each with its standing.

    Tasks are what is an instance of `leaves`, whatever is below it. Of a selector it means
    the child that it is at, or ended with; before it begins, the first that has tasks, which
    are skipped where it is at a child without any. A failure is one only if all above it
    failed, too: what is tried again goes on, and below what succeeded all the same it is
    skipped, for the reason that it says, as is what has not begun there. Where the tree failed
    for another reason, such as a condition, the next task failed; it has nothing to do where
    none had begun, unless that condition says why: then it is as far as it was `before`, if it
    was at these tasks then.
    """
    tasks = _meant(root, leaves)
    standings = [task[1] for task in tasks]
    if {*standings} <= {'skipped'}:
        return []
    if _standing(root) != 'failed' or 'failed' in standings or not {*standings} - _OVER:
        return tasks
    if {*standings} == {'ahead'}:
        if not _own_words(_failed(root)[-1]):
            return []
        known = [task[1] if task[1] in _OVER else 'ahead' for task in before]
        if [task[0] for task in before] == [task[0] for task in tasks] and 'ahead' in known:
            tasks, standings = [*before], known
    following = next(i for i, standing in enumerate(standings) if standing not in _OVER)
    standings[following] = 'failed'
    told: list[ToldTask] = []
    for task, standing in zip(tasks, standings, strict=True):
        told.append(task if task[1] == standing else (task[0], standing))
    return told


def failure_reason(root: TreeNode, leaves: Kinds) -> str:
    """Return why a tree failed, '' if it did not, or does not say.

    That is the `feedback_message` of the node that failed first, or of what an Inverter made
    it of, but not one of py_trees' own nodes, which is for developers; without one of a
    condition it is its name.
    """
    failed = _failed(root)
    if not failed:
        return ''
    is_task = any(isinstance(node, leaves) for node in failed)
    check = '' if is_task else f'This check failed: {failed[-1].name}'
    return _own_words(failed[-1]) or check


def all_tasks(root: TreeNode, leaves: Kinds) -> Iterator[str]:
    """Yield the names of all tasks of a tree, in all of its branches."""
    if isinstance(root, leaves):
        yield root.name
    else:
        for child in root.children:
            yield from all_tasks(child, leaves)


def _meant(
    node: TreeNode, leaves: Kinds, failure: str = 'failed', rest: str = 'ahead'
) -> list[ToldTask]:
    """Return the tasks at and below a node.

    There a `failure` stands for this, and what has not begun for `rest`.
    """
    standing = _standing(node)
    if isinstance(node, leaves):
        told = {'failed': failure, 'ahead': rest}.get(standing, standing)
        words = _own_words(node) if standing == 'failed' and told == 'skipped' else ''
        return [(node.name, told, words)] if words else [(node.name, told)]
    if standing == 'running':
        failure = 'running'
    elif standing == 'done':
        failure = rest = 'skipped'
    children = _children(node)
    if not _is_selector(node):
        return [task for child in children for task in _meant(child, leaves, failure, rest)]
    if not [name for child in children for name in all_tasks(child, leaves)]:
        # It is at a branch without tasks, and so does without those of another.
        children = node.children
        if standing == 'running':
            failure = rest = 'skipped'
    branches = (_meant(child, leaves, failure, rest) for child in children)
    return next(filter(None, branches), [])


def _children(node: TreeNode) -> Sequence[TreeNode]:
    """Return the children that the tree has chosen: of a selector that has begun one."""
    chosen = getattr(node, 'current_child', None) if _is_selector(node) else None
    return node.children if chosen is None else [chosen]


def _failed(root: TreeNode) -> list[TreeNode]:
    """Return the nodes that failed since those below them did, from the root on."""
    if _standing(root) != 'failed':
        return []
    below = (_failed(child) for child in _children(root))
    return [root, *next(filter(None, below), [])]


def _own_words(node: TreeNode) -> str:
    """Return what a node that failed says of itself.

    For one of py_trees' own it is what its only child says if that succeeded, as of an
    Inverter, else nothing.
    """
    if type(node).__module__.split('.')[0] != 'py_trees':
        return str(node.feedback_message or '')
    only = node.children[0] if len(node.children) == 1 else None
    return _own_words(only) if only and _standing(only) == 'done' else ''


def _is_selector(node: TreeNode) -> bool:
    return any(kind.__name__ == 'Selector' for kind in type(node).__mro__)


def _standing(node: TreeNode) -> str:
    return _STANDINGS[node.status.name]
