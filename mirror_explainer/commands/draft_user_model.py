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
from mirror_explainer.commands.command_line import command_parser
from mirror_explainer.commands.drafting.document import document
from mirror_explainer.commands.drafting.facts import Doubts, doubts
from mirror_explainer.commands.drafting.goals import Candidate, candidates
from mirror_explainer.commands.drafting.missions import Mission, read_missions
from mirror_explainer.commands.drafting.patterns import Pattern, World
from mirror_explainer.commands.drafting.reach import within_reach
from mirror_explainer.commands.drafting.words import drafted_names, drafted_words
from mirror_explainer.commands.offline import usual_rationality
from mirror_explainer.commands.options import add_settings, settings_from
from mirror_explainer.commands.terminal import tell, tell_error, tell_warning
from mirror_explainer.errors import InputError, PlanningError, some_of
from mirror_explainer.explainer import explain, robot_plan
from mirror_explainer.listener.explanation import Explanation
from mirror_explainer.listener.goals_seen import read_goals_seen
from mirror_explainer.listener.own_plan import plan_for_robot
from mirror_explainer.listener.preparation import RobotPlan, prepare, refine
from mirror_explainer.listener.robot_tasks import DOMAIN, action_text, goal_text, problem_text
from mirror_explainer.listener.user_model import CandidateGoal, UserModel, read_user_model
from mirror_explainer.pddl import Task, read_task
from mirror_explainer.planning import Planner
from mirror_explainer.settings import PlanningSettings, Question
from mirror_explainer.text_files import read_text, write_text

# Of more lists of tasks than this it is not told what the robot would answer.
_MOST_TOLD = 6
_SAYS = 'With this model, asked what it is up to, the robot says'
_HEAD = """# A first user model, drafted by draft_user_model from the robot's own texts.
# Check each part against what your listeners know, and what your robot does.
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return 0, or 2 for bad input, told on stderr."""
    parser = _parser()
    options = parser.parse_args(arguments)
    texts = (options.domain, options.problem)
    if options.tasks and any((*texts, options.plan, options.goals_seen)):
        parser.error('--tasks goes without --domain, --problem, --plan and --goals-seen')
    if not options.tasks and not all(texts):
        parser.error('--domain and --problem are required, or --tasks')
    try:
        if options.output and os.path.isfile(options.output) and not options.force:
            cure = 'Name another one as --output, or write over it with --force.'
            raise InputError(options.output, 'there is such a file already', cure=cure)
        text, answers = _of_missions(options) if options.tasks else _of_texts(options)
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


def _of_texts(options: argparse.Namespace) -> tuple[str, str]:
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
        answers, warnings = _answers(task, plan, text, planner, settings)
    return _headed(text, answers, warnings)


def _of_missions(options: argparse.Namespace) -> tuple[str, str]:
    """Return the same for a robot that has lists of tasks, and no PDDL."""
    missions = read_missions(options.tasks)
    settings = settings_from(PlanningSettings, options)
    written: dict[str, str] = {}
    for name in (name for each in missions for name in each.written):
        written.setdefault(name.lower(), name)

    def task_of(mission: Mission) -> Task:
        return read_task(DOMAIN, problem_text([*written.values()], (), goal_text(mission.tasks)))

    task, steps = task_of(missions[0]), [*map(action_text, written)]
    words = drafted_words(task, steps)
    names = drafted_names(task, words, steps)
    found = [
        Candidate(Pattern(each.parts), float(each.count), 1, f'in {options.tasks}', name=each.name)
        for each in missions
    ]
    no_doubts = Doubts((), (), 0, True)
    text = document(found, no_doubts, frozenset(), words, names, rationality=1.0)
    told: list[str] = []
    warnings: list[str] = []
    with Planner.of(settings) as planner:
        for candidate, each in zip(found[:_MOST_TOLD], missions, strict=False):
            name = each.name or names.of(candidate.pattern.parts) or candidate.pattern.goal
            own = task_of(each)
            plan = robot_plan(own, '\n'.join(map(action_text, each.tasks)))
            answers, more = _answers(own, plan, text, planner, settings)
            warnings += more
            told.append(answers.replace(_SAYS, f'{_SAYS} of "{name}"'))
    if len(missions) > _MOST_TOLD:
        told.append(f'(likewise of {len(missions) - _MOST_TOLD} more)')
    return _headed(text, '\n'.join(told), warnings)


def _headed(text: str, answers: str, warnings: Sequence[str]) -> tuple[str, str]:
    """Return the document with what the robot would answer before it; tell warnings."""
    for warning in dict.fromkeys(warnings):
        tell_warning('draft_user_model', warning)
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
) -> tuple[str, tuple[str, ...]]:
    """Return what the robot would answer with the model, with one to three sentences.

    And what there is to warn of.
    """
    user_model = read_user_model('the drafted user model', task, read=lambda _: text)
    preparation = refine(prepare(task, plan, user_model, settings), planner)
    lines = [_SAYS]
    for n in (1, 2, 3):
        explanation = explain(preparation, Question(n=n))
        if n > 1 and explanation.n < n:
            break
        lines.append(f'with at most {n}:' if n > 1 else 'with one sentence:')
        lines += [f'  {line}' for line in explanation.spoken.split('\n')]
        lines.append(f'  (its goal is then found {explanation.understanding:.0%} likely)')
        if others := _as_telling(explanation):
            lines.append(f'  (as telling in the place of one: {" ".join(others)})')
    return '\n'.join(lines), preparation.warnings


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
        'python3 -m mirror_explainer.draft_user_model --tasks tasks.txt --output user_model.yaml',
    )
    files = parser.add_argument_group('input')
    files.add_argument('--domain', help='PDDL domain')
    files.add_argument('--problem', help="PDDL problem: the robot's state and goal")
    files.add_argument('--plan', help="the robot's plan; planned for if left out")
    files.add_argument(
        '--goals-seen',
        action='extend',
        nargs='+',
        default=[],
        metavar='FILE',
        help='goals that the robot had before, as the node counts them, or one a line',
    )
    files.add_argument(
        '--tasks',
        metavar='FILE',
        help='of a robot without PDDL: what it may be told to do, a list of tasks a line, such as '
        '"serve tea: drive to the kitchen, boil water, bring the tea"; or the goals that the node '
        'counted',
    )
    add_settings(parser.add_argument_group('planning'), PlanningSettings)
    output = parser.add_argument_group('output')
    output.add_argument('--output', metavar='FILE', help='write there instead of printing')
    output.add_argument('--force', action='store_true', help='write over a file that is there')
    return parser


if __name__ == '__main__':
    sys.exit(main())
