"""The paper's user study: `python3 -m mirror_explainer.experiments.study.user_study --help`."""

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from mirror_explainer.commands.command_line import command_parser
from mirror_explainer.commands.extras import MissingExtras, require_extras
from mirror_explainer.commands.options import number, whole
from mirror_explainer.commands.terminal import tell_error
from mirror_explainer.errors import InputError, PlanningError
from mirror_explainer.experiments.study.design import GROWTHS, Answer, assignment
from mirror_explainer.experiments.study.observers import KINDS
from mirror_explainer.experiments.study.participants import Noise, simulate
from mirror_explainer.experiments.study.plans import (
    LEAST_SCENARIOS,
    PlannedScenario,
    plan_scenarios,
)
from mirror_explainer.experiments.study.scenarios import scenarios
from mirror_explainer.experiments.study.warehouse_floor import read_floor
from mirror_explainer.web.address import add_address_arguments, address


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return 0, or 2 for bad input, told on stderr."""
    options = _parser().parse_args(arguments)
    try:
        require_extras('experiments')
        options.run(options)
    except (InputError, PlanningError, MissingExtras, OSError) as error:
        tell_error('user_study', error)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


def _simulate(options: argparse.Namespace) -> None:
    """Run the study on simulated participants, and write all that comes of it."""
    # Not before the extras are known to be there.
    from mirror_explainer.experiments.study.report import results, write_report
    from mirror_explainer.experiments.study.statistics import answer_table
    from mirror_explainer.experiments.study.summary import tell_summary

    options.output.mkdir(parents=True, exist_ok=True)
    planned, left_out = plan_scenarios(scenarios(read_floor(), options.scenarios, options.seed))
    answers = answer_table(_answers(planned, options))
    command = _command(options)
    found = results(answers, options.seed)
    write_report(found, planned, left_out, options.output, command)
    tell_summary(found)
    print(f'see {options.output / "report.md"}')


def _speakers(options: argparse.Namespace) -> None:
    """Write how well simulated participants guess the goal, by whom the robot speaks to."""
    from mirror_explainer.experiments.study.speakers import simulated_speakers, write_speakers

    noise = Noise(options.temperature, options.lapse, options.confidence)
    answers = simulated_speakers(options.studies, options.scenarios, options.participants, noise)
    command = (
        'python3 -m mirror_explainer.experiments.study.user_study speakers '
        f'--studies {options.studies} --scenarios {options.scenarios} '
        f'--participants {options.participants}'
    )
    write_speakers(answers, options.output, command)
    print(f'see {options.output / "speakers.md"}')


def _serve(options: argparse.Namespace) -> None:
    """Serve the study to people."""
    require_extras('web')
    from mirror_explainer.experiments.study.web_study.serve import serve_study

    serve_study(options.database, options.scenarios, options.seed, address(options), options.study)


def _export(options: argparse.Namespace) -> None:
    """Write what people answered."""
    require_extras('web')
    from mirror_explainer.experiments.study.web_study.export import export

    export(options.database, options.output)


def _analyse(options: argparse.Namespace) -> None:
    """Write the report on people and simulated participants."""
    require_extras('web')
    from mirror_explainer.experiments.study.web_study.report import analyse

    analyse(options.database, options.output)


def _answers(planned: Sequence[PlannedScenario], options: argparse.Namespace) -> Iterator[Answer]:
    strategies = assignment(options.participants, len(planned), options.seed)
    noise = Noise(options.temperature, options.lapse, options.confidence)
    for kind in dict.fromkeys(options.observer):
        yield from simulate(planned, kind, strategies, noise, options.seed, options.informative)


def _command(options: argparse.Namespace) -> str:
    """Return the command that regenerates the report."""
    return ' '.join(
        [
            'python3 -m mirror_explainer.experiments.study.user_study simulate',
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
    program = 'python3 -m mirror_explainer.experiments.study.user_study'
    parser = command_parser(
        'user_study',
        "The paper's user study: who understands the robot, how soon.",
        f'{program} simulate --participants 20 --output simulated',
        f'{program} serve --study study.yaml --host 0.0.0.0',
        f'{program} export --output people',
    )
    commands = parser.add_subparsers(dest='command', required=True)
    simulation = commands.add_parser(
        'simulate',
        help='with simulated participants',
        description='Run the study on simulated participants.',
    )
    _simulation_arguments(simulation)
    simulation.set_defaults(run=_simulate)
    speaking = commands.add_parser(
        'speakers',
        help='simulated: words chosen for a planner, or for an open listener',
        description='Compare what simulated participants understand of words that the robot '
        'chooses for a planner, as the paper does, and of those for an open listener.',
    )
    speaking.add_argument(
        '--studies', type=whole(1), default=10, metavar='N', help='seeds 0 … N − 1 (default 10)'
    )
    _study_arguments(speaking.add_argument_group('study'), participants=5)
    _noise_arguments(speaking.add_argument_group('observers'))
    _output_argument(speaking, 'user_study_speakers')
    speaking.set_defaults(run=_speakers)
    serving = commands.add_parser(
        'serve',
        help='with people, in their browsers',
        description='Serve the study to people. What they answer is kept at once; started again '
        'with the same database, the study goes on.',
    )
    _serve_arguments(serving)
    serving.set_defaults(run=_serve)
    for name, run, what, description in (
        (
            'export',
            _export,
            'what people answered, as CSV',
            'Write answers.csv, of those who finished, with the columns of the simulated '
            "study's, and response_times.csv, of everybody.",
        ),
        (
            'analyse',
            _analyse,
            'figure, tests and report, people beside simulated participants',
            'Write what "simulate" writes, on the people who finished and on simulated '
            'participants of the same scenarios.',
        ),
    ):
        command = commands.add_parser(name, help=what, description=description)
        _database_argument(command)
        _output_argument(command, 'user_study_people')
        command.set_defaults(run=run)
    return parser


def _simulation_arguments(simulation: argparse.ArgumentParser) -> None:
    study = simulation.add_argument_group('study')
    _study_arguments(study, participants=10)
    study.add_argument(
        '--seed', type=whole(0), default=0, metavar='N', help='of all that is drawn (default 0)'
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
    _noise_arguments(people)
    _output_argument(simulation, 'user_study_results')


def _study_arguments(study: argparse._ArgumentGroup, participants: int) -> None:
    study.add_argument(
        '--participants', type=whole(2), default=participants, metavar='N',
        help='of each kind of observer (default %(default)s)',
    )  # fmt: skip
    study.add_argument(
        '--scenarios', type=whole(LEAST_SCENARIOS), default=12, metavar='N', help='default 12'
    )


def _noise_arguments(people: argparse._ArgumentGroup) -> None:
    people.add_argument(
        '--temperature', type=number(0), default=Noise.temperature, metavar='T',
        help='of the softmax between belief and answer (default %(default)s)',
    )  # fmt: skip
    people.add_argument(
        '--lapse', type=number(0, 1), default=Noise.lapse, metavar='P',
        help='probability of a slip at each step (default %(default)s)',
    )  # fmt: skip
    people.add_argument(
        '--confidence', type=number(0, 1), default=Noise.confidence, metavar='P',
        help='with less, the answer is "I don\'t know" (default %(default)s)',
    )  # fmt: skip


def _serve_arguments(serving: argparse.ArgumentParser) -> None:
    _database_argument(serving)
    serving.add_argument(
        '--study', type=Path, metavar='FILE',
        help='a study.yaml: title, consent, languages, questions and more (see docs/study.md); '
        'kept in the database, so that it need not be named again',
    )  # fmt: skip
    study = serving.add_argument_group('study', 'fixed when the database is made')
    study.add_argument('--scenarios', type=whole(LEAST_SCENARIOS), metavar='N', help='default 12')
    study.add_argument(
        '--seed', type=whole(0), metavar='N', help='of all that is drawn (default 0)'
    )
    add_address_arguments(serving, port=8000)


def _database_argument(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--database', type=Path, default=Path('user_study.sqlite3'), metavar='FILE',
        help='where the answers are kept (default: user_study.sqlite3)',
    )  # fmt: skip


def _output_argument(parser: argparse.ArgumentParser, folder: str) -> None:
    parser.add_argument(
        '--output',
        type=Path,
        default=Path(folder),
        metavar='DIR',
        help=f'write there (default: {folder})',
    )


if __name__ == '__main__':
    sys.exit(main())
