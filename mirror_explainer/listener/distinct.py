"""How much the default sentences say: enough to tell apart what a plan brings about."""

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence

from mirror_explainer.listener.roles import Atom, Roles
from mirror_explainer.pddl import words_of

Effect = tuple[str, ...]


def more_parameters(
    plan: Sequence[str], roles: Mapping[str, Roles], said: Callable[[str, int], str]
) -> dict[str, int]:
    """Return how many parameters more than usual each action's sentence must have.

    `said(action, more)` is the sentence of a ground action. Two different steps that
    sound alike are told apart where one of them brings about something that lasts to the
    plan's end, and that the other does not.
    """
    steps = [step for step in dict.fromkeys(plan) if words_of(step)[0] in roles]
    lasting = _lasting(plan, roles)
    more = dict.fromkeys(roles, 0)
    grown = True
    while grown:
        grown = False
        alike: dict[str, list[str]] = defaultdict(list)
        for step in steps:
            alike[said(step, more[words_of(step)[0]])].append(step)
        for group in alike.values():
            shared = set.intersection(*(_effects(step, roles) for step in group))
            if len(group) > 1 and any(lasting[step] - shared for step in group):
                for name in {words_of(step)[0] for step in group}:
                    if more[name] < len(roles[name].parameters):
                        more[name] += 1
                        grown = True
    return more


def _lasting(plan: Sequence[str], roles: Mapping[str, Roles]) -> dict[str, set[Effect]]:
    """Return what each action of the plan brings about that lasts to its end."""
    lasting: dict[str, set[Effect]] = {step: set() for step in plan}
    settled: set[Effect] = set()
    for step in reversed(plan):
        name, *arguments = words_of(step)
        if name in roles:
            changed = _grounded((*roles[name].made, *roles[name].undone), roles[name], arguments)
            lasting[step] |= _effects(step, roles) - settled
            settled |= changed
    return lasting


def _effects(step: str, roles: Mapping[str, Roles]) -> set[Effect]:
    """Return what a step brings about; what it ends, if nothing else."""
    name, *arguments = words_of(step)
    role = roles[name]
    made = tuple(atom for atom in role.made if not atom.about_use)
    return _grounded(made or role.undone, role, arguments)


def _grounded(atoms: Sequence[Atom], role: Roles, arguments: Sequence[str]) -> set[Effect]:
    objects = dict(zip(role.parameters, arguments, strict=True)) | {'': ''}
    return {(atom.predicate, *(objects[p] for p in atom.arguments)) for atom in atoms}
