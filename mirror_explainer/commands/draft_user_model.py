"""Draft a user model from a robot's own texts: `python3 -m mirror_explainer.draft_user_model`.

A first model to be checked by whoever knows the robot and its listeners, which `verbalize` and
the node take as it stands.
"""

import argparse
import os
import sys
from collections import Counter
from collections.abc import Sequence

import mirror_explainer.selection.one_thread  # noqa: F401
from mirror_explainer.commands.drafting.document import document
from mirror_explainer.commands.drafting.facts import doubts
from mirror_explainer.commands.drafting.goals import Candidate, candidates
from mirror_explainer.commands.drafting.patterns import World
from mirror_explainer.commands.drafting.reach import within_reach
from mirror_explainer.commands.drafting.words import drafted_names, drafted_words
from mirror_explainer.commands.offline import usual_rationality
from mirror_explainer.commands.options import add_settings, settings_from
from mirror_explainer.commands.terminal import command_parser, tell, tell_error, tell_warning
from mirror_explainer.errors import InputError, PlanningError, some_of
from mirror_explainer.explainer import explain, robot_plan
from mirror_explainer.listener.explanation import Explanation
from mirror_explainer.listener.goals_seen import read_goals_seen
from mirror_explainer.listener.preparation import RobotPlan, plan_for_robot, prepare, refine
from mirror_explainer.listener.user_model import CandidateGoal, UserModel, read_user_model
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.planning import Planner
from mirror_explainer.settings import PlanningSettings, Question
from mirror_explainer.text_files import read_text, write_text

_HEAD = """# A first user model, drafted by draft_user_model from the robot's own texts.
# Check each part against what your listeners know, and what your robot does.
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return 0, or 2 for bad input, told on stderr."""
    options = _parser().parse_args(arguments)
    try:
        if options.output and os.path.isfile(options.output) and not options.force:
            cure = 'Name another one as --output, or write over it with --force.'
            raise InputError(options.output, 'there is such a file already', cure=cure)
        text, answers = _draft(options)
        if options.output:
            write_text(options.output, text)
            tell(answers, 'bold green')
            tell(f'The draft is in {options.output}.')
        else:
            tell(text)
    except BrokenPipeError:  # whoever reads has enough, as `head` has
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except (InputError, PlanningError, OSError) as error:
        tell_error('draft_user_model', error)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


def _draft(options: argparse.Namespace) -> tuple[str, str]:
    """Return the user model's text, and what the robot would answer with it."""
    task = read_task(
        read_text(options.domain), read_text(options.problem), options.domain, options.problem
    )
    world = World(task)
    own = world.parts(task.goal_text)
    seen = _goals_seen(world, options.goals_seen)
    settings = settings_from(PlanningSettings, options)
    with Planner.of(settings) as planner:
        plan = _robot_plan(task, options, planner, settings)
        found = candidates(world, own, seen)
        found = within_reach(world, found, planner, settings.deadline / 6)
        goals = [own, *_examples(world, found, own, seen)]
        facts = doubts(world, goals, plan.plan.actions, planner, settings.deadline / 3)
        words = drafted_words(task, plan.plan.actions)
        text = document(
            found,
            facts,
            task.initial_facts,
            words,
            drafted_names(task, words, plan.plan.actions),
            usual_rationality(plan.plan),
        )
        answers = _answers(task, plan, text, planner, settings)
    commented = ''.join(f'# {line}'.rstrip() + '\n' for line in answers.split('\n'))
    return f'{_HEAD}#\n{commented}\n{text}', answers


def _goals_seen(world: World, paths: Sequence[str]) -> Counter[str]:
    """Return the goals in files with their counts; those of other problems are left out."""
    seen: Counter[str] = Counter()
    for path in paths:
        left_out = []
        for goal, count in read_goals_seen(path).counts.items():
            try:
                world.parts(goal)
                seen[goal] += count
            except InputError as error:
                left_out.append(f'{goal}: {error.reason}')
        if left_out:
            told = some_of(left_out)
            warning = f'{path}: left out as no goals of this problem: {told}'
            tell_warning('draft_user_model', warning)
    return seen


def _robot_plan(
    task: Task, options: argparse.Namespace, planner: Planner, settings: PlanningSettings
) -> RobotPlan:
    """Return the robot's plan: the one that is given, or one that is made."""
    if options.plan:
        return robot_plan(task, read_text(options.plan), options.plan)
    known = UserModel((CandidateGoal('its own', task.goal_text, 1.0),))
    plan = plan_for_robot(task, known, planner, settings, options.problem)
    return robot_plan(task, '\n'.join(plan.actions))


def _examples(
    world: World, found: Sequence[Candidate], own: Sequence[str], seen: Counter[str]
) -> list[tuple[str, ...]]:
    """Return some goals to try facts with: those seen, and one of each form."""
    examples = [world.parts(goal) for goal, _ in seen.most_common(3)]
    for candidate in (candidate for candidate in found if not candidate.left_out):
        like = (g for g in world.goals(candidate.pattern) if set(g).isdisjoint(own))
        examples += [goal for goal in [next(like, None)] if goal]
    return examples


def _answers(
    task: Task, plan: RobotPlan, text: str, planner: Planner, settings: PlanningSettings
) -> str:
    """Return what the robot would answer with the model, with one to three sentences."""
    user_model = read_user_model('the drafted user model', task, read=lambda _: text)
    preparation = refine(prepare(task, plan, user_model, settings), planner)
    lines = ['With this model, asked what it is up to, the robot says']
    for n in (1, 2, 3):
        explanation = explain(preparation, Question(n=n))
        if n > 1 and explanation.n < n:
            break
        lines.append(f'with at most {n}:' if n > 1 else 'with one sentence:')
        lines += [f'  {line}' for line in explanation.spoken.split('\n')]
        lines.append(f'  (its goal is then found {explanation.understanding:.0%} likely)')
        if others := _as_telling(explanation):
            lines.append(f'  (as telling in the place of one: {" ".join(others)})')
    return '\n'.join(lines)


def _as_telling(explanation: Explanation) -> list[str]:
    """Return what it says of other ends that would tell as much in the place of one said.

    Which of them is said hangs on probabilities that a draft can only guess.
    """
    model, said = explanation.model, set(explanation.positions)
    enough = model.doubt([*said]) + (model.listener.min_gain or 0.0)
    ends = {model.sentences[p]: p for p in model.way.aims[model.true_goal][0].positions}
    return [
        sentence
        for sentence, end in ends.items()
        if sentence not in explanation.sentences
        if any(model.doubt([*(said - {place}), end]) <= enough for place in said)
    ]


def _parser() -> argparse.ArgumentParser:
    command = 'python3 -m mirror_explainer.draft_user_model --domain D --problem P'
    parser = command_parser(
        'draft_user_model',
        "Draft a user model from a robot's domain, problem and plan.",
        command,
        f'{command} --plan plan.txt --goals-seen goals.txt --output user_model.yaml',
    )
    files = parser.add_argument_group('input')
    files.add_argument('--domain', required=True, help='PDDL domain')
    files.add_argument('--problem', required=True, help="PDDL problem: the robot's state and goal")
    files.add_argument('--plan', help="the robot's plan; planned for if left out")
    files.add_argument(
        '--goals-seen',
        action='extend',
        nargs='+',
        default=[],
        metavar='FILE',
        help='goals that the robot had before, as the node counts them, or one a line',
    )
    add_settings(parser.add_argument_group('planning'), PlanningSettings)
    output = parser.add_argument_group('output')
    output.add_argument('--output', metavar='FILE', help='write there instead of printing')
    output.add_argument('--force', action='store_true', help='write over a file that is there')
    return parser


if __name__ == '__main__':
    sys.exit(main())
