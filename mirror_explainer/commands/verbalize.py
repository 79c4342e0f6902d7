"""Explain a plan from files, without ROS: `python3 -m mirror_explainer.verbalize --help`."""

import argparse
import json
import logging
import sys
from collections.abc import Sequence
from typing import Any

from mirror_explainer.commands.offline import (
    add_file_arguments,
    add_planning_arguments,
    prepare_files,
    strategy_curves,
)
from mirror_explainer.commands.options import number, whole
from mirror_explainer.errors import InputError, PlanningError, told
from mirror_explainer.explainer import Explanation, explain
from mirror_explainer.selection.algorithm import informative_order
from mirror_explainer.settings import STRATEGIES, Question
from mirror_explainer.text_files import read_text, write_text

_log = logging.getLogger('mirror_explainer')


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return 0, or 2 for bad input, told on stderr."""
    options = _parser().parse_args(arguments)
    logging.basicConfig(format='verbalize: %(levelname)s: %(message)s', force=True)
    _log.setLevel(options.log_level.upper())
    try:
        text = _verbalize(options)
        if options.output:
            write_text(options.output, text + '\n')
        else:
            print(text)
    except (InputError, PlanningError, OSError) as error:
        print(f'verbalize: {told(error)}', file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


def _verbalize(options: argparse.Namespace) -> str:
    """Return what the command prints."""
    preparation = prepare_files(options)
    for warning in preparation.model.warnings:
        _log.warning('%s', warning)
    said = read_text(options.said).split('\n') if options.said else []
    n = options.n if options.n is not None or options.threshold > 0 else Question.n
    explanation = explain(
        preparation,
        strategy=options.strategy,
        n=n,
        threshold=options.threshold,
        said=[line.strip() for line in said if line.strip()],
        said_source=options.said or '',
        selection_budget=options.selection_budget,
    )
    order = _order(explanation) if options.order else None
    curves = (
        strategy_curves(preparation.model, explanation.said, options.selection_budget)
        if options.curve
        else None
    )
    if options.json:
        extra = {'order': order} if order is not None else {}
        extra |= {'curve': curves} if curves is not None else {}
        return json.dumps(explanation.as_dict() | extra, indent=2, ensure_ascii=False)
    parts = [explanation.text, _summary(explanation)]
    parts += [_order_table(order)] if order is not None else []
    parts += [_curve_table(curves)] if curves is not None else []
    return '\n\n'.join(parts)


def _order(explanation: Explanation) -> list[dict[str, Any]]:
    """Return the informative order: each step with its gain, and what is understood after it."""
    model = explanation.preparation.model
    heard = list(explanation.said)
    steps = []
    for step in informative_order(model.evidence(explanation.said)):
        heard.append(step.position)
        steps.append(
            {
                'position': step.position,
                'action': model.plan.actions[step.position],
                'sentence': model.sentences[step.position],
                'information_gain': step.information_gain,
                'understanding': model.understanding(heard),
            }
        )
    return steps


def _summary(explanation: Explanation) -> str:
    """Return one line on how well the listener now understands, and on what is amiss."""
    model, said, selection = explanation.preparation.model, explanation.said, explanation.selection
    after = model.understanding([*said, *selection.positions])
    summary = (
        f'The listener now finds the robot\'s goal "{model.robot_goal.name}" {after:.0%} likely '
        f'({model.understanding(said):.0%} before); '
        f'{selection.information_gain:.2f} of {model.cross_entropy(said):.2f} nats told.'
    )
    if not selection.optimal:
        summary += f' The best choice may tell up to {selection.gap:.2g} nats more.'
    if model.stand_in_plans:
        summary += (
            f' For {model.stand_in_plans} beliefs only a plan that may not be optimal is known.'
        )
    known = model.covered_mass - model.unknown_mass
    if known < 1.0 - 1e-9:
        summary += f' Only {known:.0%} of what the listener may believe could be planned for.'
    return summary


def _order_table(order: Sequence[dict[str, Any]]) -> str:
    lines = ['Informative order      gain  goal understood']
    for n, step in enumerate(order, start=1):
        gain, understanding = step['information_gain'], step['understanding']
        lines.append(f'{n:3}. {gain:+18.2f} nats  {understanding:6.0%}  {step["sentence"]}')
    return '\n'.join(lines)


def _curve_table(curves: Sequence[dict[str, Any]]) -> str:
    lines = [f'{"N":>3}' + ''.join(f'{strategy:>22}' for strategy in STRATEGIES)]
    for row in curves:
        cells = [
            f'{row[s]["information_gain"]:.2f} nats {row[s]["understanding"]:4.0%}'
            for s in STRATEGIES
        ]
        lines.append(f'{row["n"]:3}' + ''.join(f'{cell:>22}' for cell in cells))
    return '\n'.join(lines)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog='verbalize',
        description="Say the few actions of a robot's plan that tell the listener most.",
        epilog='Exit status: 0, or 2 for bad input.',
    )
    files = add_file_arguments(parser)
    files.add_argument('--said', metavar='FILE', help='sentences said earlier, one a line')
    choice = parser.add_argument_group('what to say')
    choice.add_argument(
        '-n',
        type=whole(1),
        help=f'sentences, at most (default {Question.n}; with --threshold no limit)',
    )
    choice.add_argument(
        '--threshold', type=number(0), default=0.0, metavar='NATS',
        help='say only as many as bring the cross-entropy below this',
    )  # fmt: skip
    choice.add_argument('--strategy', choices=STRATEGIES, default='informative')
    choice.add_argument(
        '--selection-budget',
        type=number(0),
        default=Question.selection_budget,
        metavar='S',
        help='to prove the best choice (default %(default)s)',
    )
    add_planning_arguments(parser)
    output = parser.add_argument_group('output')
    output.add_argument('--order', action='store_true', help='add the informative order')
    output.add_argument('--curve', action='store_true', help='add all N for all strategies')
    output.add_argument('--json', action='store_true', help='everything, as one JSON object')
    output.add_argument('--output', metavar='FILE', help='write there instead of printing')
    output.add_argument(
        '--log-level', choices=('debug', 'info', 'warning', 'error'), default='warning',
        help='how much to tell, on stderr, of how the work is done (default warning)',
    )  # fmt: skip
    return parser


if __name__ == '__main__':
    sys.exit(main())
