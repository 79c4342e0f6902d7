"""The drafted user model as YAML that says at each place what to check."""

from collections.abc import Sequence

import yaml

from mirror_explainer.commands.drafting.facts import Doubts
from mirror_explainer.commands.drafting.goals import Candidate
from mirror_explainer.commands.drafting.words import Words
from mirror_explainer.listener.goal_names import GoalNames
from mirror_explainer.listener.phrases import Phrases


def document(
    candidates: Sequence[Candidate],
    doubts: Doubts,
    true: frozenset[str],
    words: Words,
    names: GoalNames,
    rationality: float,
) -> str:
    """Return the text of the user model. `true` are the facts that hold."""
    sections = [
        _goals(candidates, names),
        _facts(doubts, true),
        _rationality(rationality),
        _words(words),
    ]
    return '\n'.join(sections)


def _goals(candidates: Sequence[Candidate], names: GoalNames) -> str:
    lines = [
        '# What the robot might be doing, by how often it does it. "for" has a type for each',
        '# {variable}. Check: are these its tasks, and do "for" and "where" leave any out? Beside',
        '# these goals a listener thinks only of them with a part less.',
        'goals:',
    ]
    last = ''
    for candidate in candidates:
        name = candidate.name or names.of(candidate.pattern.parts)
        entry: dict[str, object] = {'name': name} if name else {}
        entry['goal'] = candidate.pattern.goal
        if candidate.pattern.types:
            entry['for'] = dict(candidate.pattern.types)
        if candidate.pattern.where:
            where = candidate.pattern.where
            entry['where'] = where[0] if len(where) == 1 else f'(and {" ".join(where)})'
        entry['probability'] = round(candidate.weight, 3)
        comment = f'  # {candidate.why}{_number(candidate)}'
        if comment != last:
            lines.append(comment)
            last = comment
        mark = '  # - ' if candidate.left_out else '  - '
        lines.append(mark + _flow(entry))
    return '\n'.join(lines) + '\n'


def _number(candidate: Candidate) -> str:
    """Say how many goals a pattern stands for, and why they are left out."""
    note = f' ({candidate.left_out})' if candidate.left_out else ''
    if not candidate.pattern.types:
        return note
    return f': {candidate.count} goals{note}' if candidate.count != 1 else f': one goal{note}'


def _facts(doubts: Doubts, true: frozenset[str]) -> str:
    how = '' if doubts.complete else ' There was not time to try all of them.'
    lines = [
        '# What the listener may not know. Each of these changes what a rational robot does.',
        f'# Check: what does everybody see? Take that out.{how}',
    ]
    if doubts.facts:
        lines.append('uncertain_facts:')
        for doubt in doubts.facts:
            if len(doubt.facts) > 1:
                lines.append(f'  # These {len(doubt.facts)} change together: keep all or none.')
            changes = f'  # changes with {" ".join(doubt.others)}' if doubt.others else ''
            for fact in doubt.facts:
                probability = 0.7 if fact in true else 0.3
                entry = _flow({'fact': fact, 'probability': probability})
                lines.append(f'  - {entry}{changes}')
        if doubts.more:
            were = 'was' if doubts.more == 1 else 'were'
            lines.append(f'  # {doubts.more} more {were} found.')
    else:
        lines.append('# (No fact was found that does.)')
    if doubts.groups:
        lines += [
            '# Where things may be, the true place first. Take away "# " if they may not know.',
            '# one_of:',
        ]
        for group in doubts.groups:
            weights = {fact: 2 if place == 0 else 1 for place, fact in enumerate(group)}
            lines.append('#   - ' + _flow({'facts': weights}))
    return '\n'.join(lines) + '\n'


def _rationality(rationality: float) -> str:
    return (
        '# How strongly cheap plans are expected, per unit of cost: about 1 for a usual step.\n'
        f'rationality: {rationality:g}\n'
    )


def _words(words: Words) -> str:
    lines = ['# How each action is said. Check: would you say it so?']
    if words.sentences:
        lines.append('sentences:')
        lines += [f'  {_flow(name)}: {_quoted(text)}' for name, text in words.sentences.items()]
    lines += [f'  # {name}: {_quoted(text)}' for name, text in words.unsure.items()]
    lines += ['# What things are called.', 'objects:']
    lines += [f'  {_flow(name)}: {_flow(called)}' for name, called in words.objects.items()]
    if not words.objects:
        lines[-1] = '# objects: {}'
    default = Phrases()
    lines += ['# What else may be said, and is said so unless you change it.', '# phrases:']
    lines += [
        f'#   {name}: {_quoted(getattr(default, field))}'
        for name, field in zip(Phrases.names(), default.__dataclass_fields__, strict=True)
    ]
    return '\n'.join(lines) + '\n'


def _flow(value: object) -> str:
    """Return a value as YAML on one line."""
    text = yaml.safe_dump(
        value, default_flow_style=True, sort_keys=False, allow_unicode=True, width=10**6
    )
    return text.removesuffix('\n').removesuffix('\n...')


def _quoted(text: str) -> str:
    escaped = text.replace('\\', '\\\\').replace('"', '\\"')
    return f'"{escaped}"'
