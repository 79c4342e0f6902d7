"""The three strategies side by side on your own domain: `python3 -m … .compare --help`.

The paper's Table 1 as text, and a figure of understanding and information gain
against N: what it takes to choose `n`, `threshold` and `rationality` for a robot.
"""

import argparse
import math
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import mirror_explainer.selection.one_thread  # noqa: F401
from mirror_explainer.commands.command_line import command_parser
from mirror_explainer.commands.extras import MissingExtras, require_extras
from mirror_explainer.commands.offline import (
    add_file_arguments,
    add_planning_arguments,
    prepare_as_asked,
    strategy_curves,
    usual_rationality,
)
from mirror_explainer.commands.options import number
from mirror_explainer.commands.terminal import tell, tell_error, tell_warning
from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.listener.listeners import chosen
from mirror_explainer.listener.mirror_model import MirrorModel
from mirror_explainer.planning import Plan
from mirror_explainer.selection.baselines import ORDERS
from mirror_explainer.selection.choice import informative_order
from mirror_explainer.selection.enumeration import TIE
from mirror_explainer.settings import LISTENERS, STRATEGIES
from mirror_explainer.text_files import write_text

# How sure of the goal the listener should be; 0.85 is the paper's headline.
LEVELS = (0.5, 0.85, 0.95)
_RECOMMENDED = 0.85
# Of all that sentences can tell: what more than that adds is little.
_MOST = 0.9


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return 0, or 2 for bad input, told on stderr."""
    options = _parser().parse_args(arguments)
    try:
        require_extras('experiments')
        preparation = prepare_as_asked(options)
        model = preparation.model_for(chosen(preparation.listener, options.listener))
        for warning in preparation.warnings:
            tell_warning('compare', warning)
        if not model.sentences:
            raise InputError(
                options.problem, "the robot's goal is reached: nothing is left to say"
            )
        curves = strategy_curves(model, budget=options.selection_budget)
        both = {}
        for name in LISTENERS:
            other = preparation.model_for(chosen(preparation.listener, name))
            both[name] = curves if other is model else strategy_curves(other)
        tables = '\n\n'.join(
            [spoken_orders(model), gains(curves), levels(curves), either_listener(both)]
        )
        hints = f'{hint(curves)}\n\n{cost_hint(model.plan, preparation.rationality)}'
        if options.output:
            write_text(options.output, f'{tables}\n\n{hints}\n')
        else:
            tell(f'{tables}\n')
            tell(hints, 'bold green')
        if options.figure:
            # Not before the extras are known to be there.
            from mirror_explainer.commands.compare_figure import comparison_figure
            from mirror_explainer.commands.figures import save

            path = options.figure.with_suffix('') if _is_image(options.figure) else options.figure
            png, svg = save(comparison_figure(model, curves, LEVELS), path)
            print(f'\nFigure: {png}, {svg}')
    except (InputError, PlanningError, MissingExtras, OSError) as error:
        tell_error('compare', error)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


def spoken_orders(model: MirrorModel) -> str:
    """Return the paper's Table 1: all sentences in the order in which each strategy adds them."""
    evidence = model.evidence()
    informative = [model.sentences[added.position] for added in informative_order(evidence)]
    increasing, decreasing = (
        [model.sentences[evidence.positions[column]] for column in order(evidence)]
        for order in ORDERS.values()
    )
    n = range(1, len(informative) + 1)
    rows = zip(n, increasing, decreasing, informative, strict=True)
    headers = ['', 'Increasing order', 'Decreasing order', 'Informative order']
    return _table(list(rows), headers, maxcolwidths=[None, 44, 44, 44])


def gains(curves: Sequence[Mapping[str, Any]]) -> str:
    """Return what each strategy achieves at every N."""
    rows = [
        [row['n']]
        + [
            f'{row[s]["understanding"]:4.0%} {row[s]["information_gain"] + 0.0:6.2f}'
            for s in reversed(STRATEGIES)
        ]
        for row in curves
    ]
    headers = ['N', *reversed(STRATEGIES)]
    return (
        'Goal understood, and nats told, with N sentences (for N given, informative says the '
        'best set,\nnot the first N of the order above, and none whose gain is below '
        'min_gain):\n\n' + _table(rows, headers, stralign='right')
    )


def levels(curves: Sequence[Mapping[str, Any]]) -> str:
    """Return at which N each strategy first brings the listener to each level."""
    rows = [
        [f'{level:.0%}', *(reached(curves, s, level) or 'never' for s in reversed(STRATEGIES))]
        for level in LEVELS
    ]
    headers = ['goal understood', *(f'N {strategy}' for strategy in reversed(STRATEGIES))]
    return _table(rows, headers, stralign='right', numalign='right')


def either_listener(curves: Mapping[str, Sequence[Mapping[str, Any]]]) -> str:
    """Return what each listener makes of what is best for them, and where that flattens."""
    most = max(flattens(rows, 1.0) for rows in curves.values())
    shown = [
        [n + 1, *(f'{rows[n]["informative"]["understanding"]:.0%}' for rows in curves.values())]
        for n in range(most)
    ]
    flat = ', '.join(f'n: {flattens(rows, _MOST)} for {name}' for name, rows in curves.items())
    return (
        'Goal understood by either listener, each told what is best for them, and no more with '
        'more sentences:\n\n'
        + _table(shown, ['N', *curves], stralign='right')
        + f'\n\nThe curves flatten, with {_MOST:.0%} of all nats told, at {flat}.'
    )


def flattens(curves: Sequence[Mapping[str, Any]], share: float) -> int:
    """Return the smallest N that tells this share of what can be told."""
    gains = [row['informative']['information_gain'] for row in curves]
    return 1 + next(n for n, gain in enumerate(gains) if gain >= share * max(gains) - TIE)


def cost_hint(plan: Plan, rationality: float) -> str:
    """Return what the costs of actions say of the `rationality` that there is."""
    usual = plan.cost / len(plan.actions)
    if not usual:
        return "Hint: the plan's steps cost nothing: rationality plays no part."
    fitting = usual_rationality(plan)
    advice = (
        'That is as usual.'
        if 0.5 <= rationality / fitting <= 2.0
        else f'rationality: {fitting:g} would make that e = 2.7 times, as is usual.'
    )
    return (
        f'Hint: a step of the plan costs {usual:.3g} in the mean. With rationality: '
        f'{rationality:g} a way that is longer\nby one such step is '
        f'e^{rationality * usual:.2g} times less expected. {advice}'
    )


def reached(curves: Sequence[Mapping[str, Any]], strategy: str, level: float) -> int | None:
    """Return the smallest N with which the goal is understood to this level."""
    return next(
        (row['n'] for row in curves if row[strategy]['understanding'] >= level - TIE), None
    )


def hint(curves: Sequence[Mapping[str, Any]]) -> str:
    """Return which `n` and `threshold` to give the robot."""
    n = reached(curves, 'informative', _RECOMMENDED)
    if n is None:
        best = max(row['informative']['understanding'] for row in curves)
        most = reached(curves, 'informative', best)
        return (
            f'Hint: n: {most} tells all there is to tell, and leaves the listener {best:.0%} sure '
            'of the goal. If that is little,\nsome candidates may have ends that are said alike: '
            'word them apart. Of many candidates that share ends\nsome doubt stays '
            '(other_ends of the listener).'
        )
    achieved = curves[n - 1]['informative']['understanding']
    increasing, decreasing = (
        reached(curves, strategy, _RECOMMENDED) or 'more than there are'
        for strategy in ('increasing', 'decreasing')
    )
    threshold = -math.log(_RECOMMENDED)
    enough = sufficient(curves, threshold)
    doubt = curves[enough - 1]['informative']['doubt']
    comes_to = '' if doubt < threshold else f', which leave the least, {doubt:.2f}'
    facts = '' if enough == n else '\n(Doubt is about the facts that they are unsure of, too.)'
    return (
        f'Hint: n: {n} makes the listener {achieved:.0%} sure of the goal; increasing takes '
        f'{increasing} sentences for {_RECOMMENDED:.0%}, decreasing {decreasing}.\n'
        f'threshold: {threshold:.2f} (nats; -ln {_RECOMMENDED}) says as few as bring the doubt '
        f'below it, if the whole plan can:\n{enough} of this one{comes_to}. Set n to the most '
        f'it may say.{facts}'
    )


def sufficient(curves: Sequence[Mapping[str, Any]], threshold: float) -> int:
    """Return how many sentences `explain` says with this threshold, and no other limit."""
    doubts = [row['informative']['doubt'] for row in curves]
    return 1 + next(
        i for i, doubt in enumerate(doubts) if doubt < threshold or doubt <= min(doubts) + TIE
    )


def _table(rows: Sequence[Sequence[Any]], headers: Sequence[str], **layout: Any) -> str:
    # Not before the extras are known to be there.
    from tabulate import tabulate  # type: ignore[import-untyped]

    return str(tabulate(rows, headers=headers, **layout))


def _is_image(path: Path) -> bool:
    return path.suffix.lower() in ('.png', '.svg')


def _parser() -> argparse.ArgumentParser:
    command = 'python3 -m mirror_explainer.commands.compare --domain D --problem P --user-model U'
    parser = command_parser(
        'compare',
        'Set the three strategies side by side on your own domain.',
        command,
        f'{command} --listener planner --figure compared',
    )
    add_file_arguments(parser)
    parser.add_argument(
        '--listener', choices=['', *LISTENERS], default='', help="empty: the user model's"
    )
    add_planning_arguments(parser)
    output = parser.add_argument_group('output')
    output.add_argument(
        '--selection-budget', type=number(0), default=10.0, metavar='S', help='default 10 s'
    )
    output.add_argument(
        '--figure', type=Path, metavar='FILE', help='draw a figure: FILE.png and FILE.svg'
    )
    output.add_argument('--output', metavar='FILE', help='write there instead of printing')
    return parser


if __name__ == '__main__':
    sys.exit(main())
