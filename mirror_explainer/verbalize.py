"""Explain a plan from files, without ROS: `python3 -m mirror_explainer.verbalize --help`."""

import argparse
import json
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.explainer import (
    STRATEGIES,
    Explanation,
    Preparation,
    explain,
    prepare,
    robot_plan,
)
from mirror_explainer.mirror_model import MirrorModel
from mirror_explainer.pddl import read_task
from mirror_explainer.planning import Planner
from mirror_explainer.selection import Selection, curve, decreasing, increasing, informative_order
from mirror_explainer.user_model import read_user_model


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return 0, or 2 for bad input, told on stderr."""
    options = _parser().parse_args(arguments)
    try:
        text = _verbalize(options)
        if options.output:
            Path(options.output).write_text(text + '\n', encoding='utf-8')
        else:
            print(text)
    except (InputError, PlanningError, OSError) as error:
        print(f'verbalize: {error}', file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


def _verbalize(options: argparse.Namespace) -> str:
    """Return what the command prints."""
    preparation = _prepare(options)
    for warning in preparation.model.warnings:
        print(f'verbalize: warning: {warning}', file=sys.stderr)
    said = _read(options.said).split('\n') if options.said else []
    n = options.n if options.n is not None or options.threshold > 0 else 3
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
    curves = _curves(explanation, options.selection_budget) if options.curve else None
    if options.json:
        extra = {'order': order} if order is not None else {}
        extra |= {'curve': curves} if curves is not None else {}
        return json.dumps(explanation.as_dict() | extra, indent=2, ensure_ascii=False)
    parts = [explanation.text, _summary(explanation)]
    parts += [_order_table(order)] if order is not None else []
    parts += [_curve_table(curves)] if curves is not None else []
    return '\n\n'.join(parts)


def _prepare(options: argparse.Namespace) -> Preparation:
    started = time.perf_counter()
    task = read_task(
        _read(options.domain), _read(options.problem), options.domain, options.problem
    )
    plan = robot_plan(task, _read(options.plan), options.plan) if options.plan else None
    user_model = read_user_model(options.user_model, task)
    read = time.perf_counter() - started
    with Planner(
        options.planner, workers=options.workers, planning_timeout=options.planning_timeout
    ) as planner:
        preparation = prepare(
            task,
            plan,
            user_model,
            planner,
            max_beliefs=options.max_beliefs,
            plans_per_belief=options.plans_per_belief,
            deadline=options.deadline,
        )
    return replace(preparation, seconds=replace(preparation.seconds, read=read))


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


def _curves(explanation: Explanation, budget: float) -> list[dict[str, Any]]:
    """Return, for every N, what each strategy achieves."""
    model, said = explanation.preparation.model, explanation.said
    evidence = model.evidence(said)
    best = curve(evidence, budget)
    return [
        {
            'n': n,
            'informative': _measures(best[n], model, said),
            'increasing': _measures(increasing(evidence, n), model, said),
            'decreasing': _measures(decreasing(evidence, n), model, said),
        }
        for n in range(1, len(evidence.positions) + 1)
    ]


def _measures(selection: Selection, model: MirrorModel, said: Sequence[int]) -> dict[str, Any]:
    heard = [*said, *selection.positions]
    return {
        'positions': list(selection.positions),
        'information_gain': selection.information_gain,
        'cross_entropy': model.cross_entropy(heard),
        'understanding': model.understanding(heard),
        'gap': selection.gap,
    }


def _summary(explanation: Explanation) -> str:
    """Return one line on how well the listener now understands, and on what is amiss."""
    told = explanation.as_dict(hypotheses=False)
    model = explanation.preparation.model
    goal = model.goals[model.hypotheses[model.robot].goal].name
    summary = (
        f'The listener now finds the robot\'s goal "{goal}" {told["understanding"]:.0%} likely '
        f'({told["understanding_before"]:.0%} before); '
        f'{told["information_gain"]:.2f} of {told["cross_entropy_before"]:.2f} nats told.'
    )
    if not explanation.selection.optimal:
        summary += f' The best choice may tell up to {told["gap"]:.2g} nats more.'
    if not model.complete:
        known = model.covered_mass - model.unknown_mass
        summary += f' Only {known:.0%} of what the listener may believe could be planned for.'
    return summary


def _order_table(order: Sequence[dict[str, Any]]) -> str:
    lines = ['Informative order      gain  goal understood']
    for number, step in enumerate(order, start=1):
        gain, understanding = step['information_gain'], step['understanding']
        lines.append(f'{number:3}. {gain:+18.2f} nats  {understanding:6.0%}  {step["sentence"]}')
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


def _read(path: str) -> str:
    try:
        return Path(path).read_text(encoding='utf-8-sig')
    except UnicodeDecodeError as error:
        raise InputError(path, f'this is no UTF-8 text: {error.reason}') from error
    except OSError as error:
        raise InputError(path, f'the file cannot be read: {error.strerror}') from error


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog='verbalize',
        description="Say the few actions of a robot's plan that tell the listener most.",
        epilog='Exit status: 0, or 2 for bad input.',
    )
    files = parser.add_argument_group('input')
    files.add_argument('--domain', required=True, help='PDDL domain')
    files.add_argument('--problem', required=True, help="PDDL problem: the robot's state and goal")
    files.add_argument('--plan', help="the robot's plan; planned for if left out")
    files.add_argument('--user-model', required=True, help='YAML: what the listener may believe')
    files.add_argument('--said', metavar='FILE', help='sentences said earlier, one a line')
    choice = parser.add_argument_group('what to say')
    choice.add_argument(
        '-n',
        type=_count,
        help='how many sentences (default 3; with --threshold as many as needed)',
    )
    choice.add_argument(
        '--threshold', type=_seconds, default=0.0, metavar='NATS',
        help='say only as many as bring the cross-entropy below this',
    )  # fmt: skip
    choice.add_argument('--strategy', choices=STRATEGIES, default='informative')
    choice.add_argument(
        '--selection-budget', type=_seconds, default=0.5, metavar='S', help='default 0.5 s'
    )
    planning = parser.add_argument_group('planning')
    planning.add_argument(
        '--planner', default='fast-downward-opt', metavar='ENGINE',
        help="unified-planning's name of the engine (default fast-downward-opt)",
    )  # fmt: skip
    planning.add_argument('--plans-per-belief', type=_positive, default=1, metavar='K')
    planning.add_argument('--max-beliefs', type=_positive, default=1024, metavar='M')
    planning.add_argument(
        '--planning-timeout', type=_seconds, default=10.0, metavar='S', help='per belief'
    )
    planning.add_argument(
        '--deadline', type=_seconds, default=60.0, metavar='S', help='for all planning'
    )
    planning.add_argument('--workers', type=_positive, default=2, help='planning processes')
    output = parser.add_argument_group('output')
    output.add_argument('--order', action='store_true', help='add the informative order')
    output.add_argument('--curve', action='store_true', help='add all N for all strategies')
    output.add_argument('--json', action='store_true', help='everything, as one JSON object')
    output.add_argument('--output', metavar='FILE', help='write there instead of printing')
    return parser


def _count(text: str) -> int:
    return _at_least(0, text)


def _positive(text: str) -> int:
    return _at_least(1, text)


def _seconds(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float('nan')
    if not 0 <= value < float('inf'):
        raise argparse.ArgumentTypeError(f'"{text}" is no number from 0 up')
    return value


def _at_least(least: int, text: str) -> int:
    if not text.isdecimal() or int(text) < least:
        raise argparse.ArgumentTypeError(f'"{text}" is no whole number from {least} up')
    return int(text)


if __name__ == '__main__':
    sys.exit(main())
