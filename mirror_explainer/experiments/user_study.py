"""The paper's user study: `python3 -m mirror_explainer.experiments.user_study simulate --help`."""

import argparse
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from mirror_explainer.errors import InputError, PlanningError, told
from mirror_explainer.experiments.observers import KINDS
from mirror_explainer.experiments.participants import Noise, simulate
from mirror_explainer.experiments.scenarios import Scenario, scenarios
from mirror_explainer.experiments.study_design import GROWTHS, Answer, assignment
from mirror_explainer.experiments.study_plans import PlannedScenario, plan_scenario
from mirror_explainer.experiments.warehouse_files import read_floor
from mirror_explainer.extras import MissingExtras, require_extras
from mirror_explainer.planning import Planner

_LEAST_SCENARIOS = 3  # so that everybody hears every strategy


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return 0, or 2 for bad input, told on stderr."""
    options = _parser().parse_args(arguments)
    try:
        require_extras('experiments')
        _simulate(options)
    except (InputError, PlanningError, MissingExtras, OSError) as error:
        print(f'user_study: {told(error)}', file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    print(f'see {options.output / "report.md"}')
    return 0


def _simulate(options: argparse.Namespace) -> None:
    """Run the study on simulated participants, and write all that comes of it."""
    # Not before the extras are known to be there.
    from mirror_explainer.experiments.study_report import results, write_report
    from mirror_explainer.experiments.study_statistics import answer_table

    options.output.mkdir(parents=True, exist_ok=True)
    planned, left_out = _plan(scenarios(read_floor(), options.scenarios, options.seed))
    for name, reason in left_out.items():
        print(f'user_study: left out: {name}: {reason}', file=sys.stderr)
    if len(planned) < _LEAST_SCENARIOS:
        raise PlanningError(
            f'only {len(planned)} scenarios could be planned for',
            cure='Ask for fewer, or give planning more time.',
        )
    answers = answer_table(_answers(planned, options))
    command = _command(options)
    write_report(results(answers, options.seed), planned, left_out, options.output, command)


def _plan(drawn: Sequence[Scenario]) -> tuple[list[PlannedScenario], dict[str, str]]:
    """Return the scenarios with their plans, and of those left out the reason by name."""
    from tqdm import tqdm

    planned, left_out = [], {}
    with Planner() as planner:
        for scenario in tqdm(drawn, unit='scenario', disable=None):
            try:
                planned.append(plan_scenario(scenario, planner))
            except PlanningError as error:
                left_out[scenario.name] = str(error)
    return planned, left_out


def _answers(planned: Sequence[PlannedScenario], options: argparse.Namespace) -> Iterator[Answer]:
    strategies = assignment(options.participants, len(planned), options.seed)
    noise = Noise(options.temperature, options.lapse, options.confidence)
    for kind in dict.fromkeys(options.observer):
        yield from simulate(planned, kind, strategies, noise, options.seed, options.informative)


def _command(options: argparse.Namespace) -> str:
    """Return the command that regenerates the report."""
    return ' '.join(
        [
            'python3 -m mirror_explainer.experiments.user_study simulate',
            *(
                f'--{name} {getattr(options, name)}'
                for name in (
                    'participants',
                    'scenarios',
                    'seed',
                    'informative',
                    'temperature',
                    'lapse',
                    'confidence',
                )  # fmt: skip
            ),
            *([] if options.observer == list(KINDS) else ['--observer', *options.observer]),
        ]
    )


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog='user_study',
        description="The paper's user study: who understands the robot, how soon.",
        epilog='Exit status: 0, or 2 for bad input.',
    )
    commands = parser.add_subparsers(dest='command', required=True)
    simulation = commands.add_parser(
        'simulate',
        help='with simulated participants',
        description='Run the study on simulated participants.',
    )
    study = simulation.add_argument_group('study')
    study.add_argument(
        '--participants', type=_from(2), default=10, metavar='N',
        help='of each kind of observer (default 10)',
    )  # fmt: skip
    study.add_argument(
        '--scenarios', type=_from(_LEAST_SCENARIOS), default=12, metavar='N', help='default 12'
    )
    study.add_argument(
        '--seed', type=_from(0), default=0, metavar='N', help='of all that is drawn (default 0)'
    )
    study.add_argument(
        '--informative', choices=GROWTHS, default=GROWTHS[0],
        help='how the informative verbalization grows: a sentence a step, or by the best set '
        'of each size (default order)',
    )  # fmt: skip
    people = simulation.add_argument_group('observers')
    people.add_argument(
        '--observer', nargs='+', choices=list(KINDS), default=list(KINDS), metavar='KIND',
        help='; '.join(f'{kind}: {what}' for kind, what in KINDS.items()) + ' (default: all)',
    )  # fmt: skip
    people.add_argument(
        '--temperature', type=_not_negative, default=Noise.temperature, metavar='T',
        help='of the softmax between belief and answer (default %(default)s)',
    )  # fmt: skip
    people.add_argument(
        '--lapse', type=_share, default=Noise.lapse, metavar='P',
        help='probability of a slip at each step (default %(default)s)',
    )  # fmt: skip
    people.add_argument(
        '--confidence', type=_share, default=Noise.confidence, metavar='P',
        help='with less, the answer is "I don\'t know" (default %(default)s)',
    )  # fmt: skip
    simulation.add_argument(
        '--output', type=Path, default=Path('user_study_results'), metavar='DIR',
        help='default: user_study_results',
    )  # fmt: skip
    return parser


def _from(least: int) -> Callable[[str], int]:
    def number(text: str) -> int:
        if not text.isdecimal() or int(text) < least:
            raise argparse.ArgumentTypeError(f'"{text}" is no whole number from {least} up')
        return int(text)

    return number


def _not_negative(text: str) -> float:
    return _within(float('inf'), text)


def _share(text: str) -> float:
    return _within(1.0, text)


def _within(most: float, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float('nan')
    if not 0 <= value <= most or value == float('inf'):
        limit = 'up' if most == float('inf') else f'to {most:g}'
        raise argparse.ArgumentTypeError(f'"{text}" is no number from 0 {limit}')
    return value


if __name__ == '__main__':
    sys.exit(main())
