"""Explain a plan from files, without ROS: `python3 -m mirror_explainer.verbalize --help`."""

import argparse
import json
import logging
import os
import sys
from collections.abc import Sequence
from typing import Any

import mirror_explainer.selection.one_thread  # noqa: F401
from mirror_explainer.commands.command_line import command_parser
from mirror_explainer.commands.in_words import in_words
from mirror_explainer.commands.offline import (
    add_file_arguments,
    add_planning_arguments,
    prepare_as_asked,
    strategy_curves,
)
from mirror_explainer.commands.options import add_settings, settings_from, whole
from mirror_explainer.commands.score import score_table, scores
from mirror_explainer.commands.terminal import tell, tell_error
from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.explainer import explain
from mirror_explainer.listener.explanation import Explanation
from mirror_explainer.selection.choice import informative_order
from mirror_explainer.settings import STRATEGIES, Question, meaning_of
from mirror_explainer.text_files import read_text, write_text

_log = logging.getLogger('mirror_explainer')


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return 0, or 2 for bad input, told on stderr."""
    options = _parser().parse_args(arguments)
    logging.basicConfig(format='verbalize: %(levelname)s: %(message)s', force=True)
    _log.setLevel(options.log_level.upper())
    try:
        answer, *others = _verbalize(options)
        if options.output:
            write_text(options.output, '\n\n'.join([answer, *others]) + '\n')
        else:
            tell(answer, '' if options.json else 'bold green')
            for part in others:
                print(f'\n{part}', flush=True)
    except BrokenPipeError:  # whoever reads has enough, as `head` has
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except (InputError, PlanningError, OSError) as error:
        tell_error('verbalize', error)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


def _verbalize(options: argparse.Namespace) -> list[str]:
    """Return what the command prints, the answer first."""
    preparation = prepare_as_asked(options)
    for warning in preparation.warnings:
        _log.warning('%s', warning)
    if options.save_plan:
        write_text(options.save_plan, '\n'.join([*preparation.way.plan.actions, '']))
    said = read_text(options.said).split('\n') if options.said else []
    n = options.n or (meaning_of(Question, 'n').most if options.threshold > 0 else Question.n)
    explanation = explain(
        preparation,
        settings_from(Question, options, n=int(n)),
        said=[line.strip() for line in said if line.strip()],
        said_source=options.said or '',
    )
    order = _order(explanation) if options.order else None
    curves = (
        strategy_curves(explanation.model, explanation.known, options.selection_budget)
        if options.curve
        else None
    )
    score = scores(explanation, options.score) if options.score else None
    if options.json:
        extra: dict[str, Any] = {'order': order} if order is not None else {}
        extra |= {'score': score} if score is not None else {}
        extra |= {'curve': curves} if curves is not None else {}
        return [json.dumps(explanation.as_dict() | extra, indent=2, ensure_ascii=False)]
    parts = [explanation.spoken, in_words(explanation)]
    parts += [score_table(score, explanation.understanding_before)] if score is not None else []
    parts += [_order_table(order)] if order is not None else []
    parts += [_curve_table(curves, explanation)] if curves is not None else []
    return parts


def _order(explanation: Explanation) -> list[dict[str, Any]]:
    """Return the informative order: each step with its gain, and what is understood after it."""
    model = explanation.model
    heard = list(explanation.known)
    steps = []
    for addition in informative_order(model.evidence(explanation.known)):
        heard.append(addition.position)
        steps.append(
            {
                'position': addition.position,
                'action': model.plan.actions[addition.position],
                'sentence': model.sentences[addition.position],
                'information_gain': addition.information_gain,
                'understanding': model.understanding(heard),
            }
        )
    return steps


def _order_table(order: Sequence[dict[str, Any]]) -> str:
    lines = ['Informative order      gain  goal understood']
    for n, step in enumerate(order, start=1):
        gain, understanding = _nats(step['information_gain']), step['understanding']
        lines.append(f'{n:3}. {gain:>+18.2f} nats  {understanding:6.0%}  {step["sentence"]}')
    return '\n'.join(lines)


def _curve_table(curves: Sequence[dict[str, Any]], explanation: Explanation) -> str:
    lines = [f'{"N":>3}' + ''.join(f'{strategy:>22}' for strategy in STRATEGIES)]
    for row in curves:
        cells = [
            f'{_nats(row[s]["information_gain"]):.2f} nats {row[s]["understanding"]:4.0%}'
            for s in STRATEGIES
        ]
        lines.append(f'{row["n"]:3}' + ''.join(f'{cell:>22}' for cell in cells))
    if any(len(row['informative']['positions']) < row['n'] for row in curves):
        lines.append(
            '(Informative says at most N sentences, and stops where all further ones together '
            f'would tell\nless than min_gain, {explanation.model.listener.min_gain:g} nats; the '
            'others say N, whatever they tell.)'
        )
    return '\n'.join(lines)


def _nats(value: float) -> float:
    """Return a value that is not shown as -0.00."""
    return round(value, 2) + 0.0


def _parser() -> argparse.ArgumentParser:
    command = 'python3 -m mirror_explainer.verbalize --domain D --problem P --user-model U'
    parser = command_parser(
        'verbalize',
        "Say the few actions of a robot's plan that tell the listener most.",
        command,
        f'{command} --plan plan.txt -n 2 --order',
        f'{command} --json --output answer.json',
    )
    files = add_file_arguments(parser)
    files.add_argument(
        '--said',
        metavar='FILE',
        help='sentences said earlier, one a line, as in `sentences` of --json',
    )
    choice = parser.add_argument_group('what to say')
    choice.add_argument(
        '-n',
        '--n',
        type=whole(1, meaning_of(Question, 'n').most),
        help=f'sentences, at most (default {Question.n}; with --threshold no limit)',
    )
    add_settings(choice, Question, 'n')
    add_planning_arguments(parser)
    output = parser.add_argument_group('output')
    output.add_argument('--order', action='store_true', help='add the informative order')
    output.add_argument(
        '--score', nargs='+', metavar='SENTENCE', help='add what these sentences would tell'
    )
    output.add_argument('--curve', action='store_true', help='add all N for all strategies')
    output.add_argument('--json', action='store_true', help='everything, as one JSON object')
    output.add_argument('--save-plan', metavar='FILE', help="write the robot's plan there, too")
    output.add_argument('--output', metavar='FILE', help='write there instead of printing')
    output.add_argument(
        '--log-level', choices=('debug', 'info', 'warning', 'error'), default='warning',
        help='how much to tell, on stderr, of how the work is done (default warning)',
    )  # fmt: skip
    return parser


if __name__ == '__main__':
    sys.exit(main())
