"""The tasks of a behaviour tree of py_trees: what it means to do, and how far it is with that.

Nothing of py_trees is imported: what is needed of it are names, children and statuses.
"""

from collections.abc import Iterator, Sequence
from typing import Any, Protocol

# What a task is called whose status has this name.
_STANDINGS = {'INVALID': 'ahead', 'RUNNING': 'running', 'SUCCESS': 'done', 'FAILURE': 'failed'}

Kinds = type | tuple[type, ...]


class TreeNode(Protocol):
    """A `py_trees.behaviour.Behaviour`. Composites have a `current_child`, too."""

    name: str
    status: Any

    @property
    def children(self) -> Sequence[Any]:
        """Those below it; one for a decorator, none for a leaf."""


def tree_tasks(root: TreeNode, leaves: Kinds) -> list[tuple[str, str]]:
    """Return the tasks that a tree means to do, in order, each with its standing.

    Tasks are what is an instance of `leaves`, whatever is below it. Of a selector it means
    the child that it is at, or ended with, and before it begins the first. A failure is one
    only if all above it failed, too: what is tried again goes on, and what may fail is left
    out. Where the tree failed for another reason, such as a condition, the next task failed;
    it has nothing to do where none had begun.
    """
    tasks = list(_meant(root, leaves, 'failed'))
    standings = [standing for _, standing in tasks]
    if _standing(root) != 'failed' or 'failed' in standings or 'ahead' not in standings:
        return tasks
    following = standings.index('ahead')
    if standings == ['ahead'] * len(tasks):
        return []
    return [*tasks[:following], (tasks[following][0], 'failed'), *tasks[following + 1 :]]


def all_tasks(root: TreeNode, leaves: Kinds) -> Iterator[str]:
    """Yield the names of all tasks of a tree, in all of its branches."""
    if isinstance(root, leaves):
        yield root.name
    else:
        for child in root.children:
            yield from all_tasks(child, leaves)


def _meant(node: TreeNode, leaves: Kinds, failure: str) -> Iterator[tuple[str, str]]:
    """Yield the tasks at and below a node; a `failure` stands for this, '' if for nothing."""
    standing = _standing(node)
    if isinstance(node, leaves):
        standing = failure if standing == 'failed' else standing
        if standing:
            yield node.name, standing
        return
    failure = {'running': 'running', 'done': ''}.get(standing, failure)
    for child in _branches(node):
        yield from _meant(child, leaves, failure)


def _branches(node: TreeNode) -> Sequence[TreeNode]:
    """Return the children that the tree means to run."""
    if any(kind.__name__ == 'Selector' for kind in type(node).__mro__):
        current = getattr(node, 'current_child', None)
        return node.children[:1] if current is None else [current]
    return node.children


def _standing(node: TreeNode) -> str:
    return _STANDINGS[node.status.name]
