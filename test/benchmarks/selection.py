"""How long choosing takes, and how near to the best it comes, where very much is possible.

`scripts/benchmark selection` draws instances of 100,000 hypotheses about a plan of 50 steps
(30 different goals of three of 12 ends each; a foreseen way has its ends and a random half of
47 means; an unforeseen one a goal), and asks for three sentences within the usual budget. It
prints how long the model's building and the choosing (with all that is made for it) take, in
multiples of `import numpy` in the same run, and the gap. Exit status 1 if of more than one in
ten the gap is 0.1 nats or more, or the choosing takes longer than the budget.
"""

import argparse
import itertools
import subprocess
import sys
import time
from collections.abc import Sequence
from random import Random

import mirror_explainer.selection.one_thread  # noqa: F401
from mirror_explainer.listener.ends import aims
from mirror_explainer.listener.goals import Part
from mirror_explainer.listener.listeners import LISTENERS
from mirror_explainer.listener.prior import Prior
from mirror_explainer.listener.user_model import CandidateGoal
from mirror_explainer.listener.way import Way
from mirror_explainer.listener.weighing import mirror_model
from mirror_explainer.planning import Belief, BeliefPlans, BeliefSpace, Plan, Status
from mirror_explainer.selection.choice import most_informative
from mirror_explainer.settings import Question

ENDS, STEPS, GOALS, PARTS = 12, 50, 30, 3


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; return 1 where the promise is not kept."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--instances', type=int, default=10)
    parser.add_argument('--hypotheses', type=int, default=100_000)
    parser.add_argument('-n', type=int, default=3)
    parser.add_argument('--listener', choices=[*LISTENERS], default='open')
    options = parser.parse_args(arguments)
    unit = _seconds_to_import_numpy()
    print(f'unit: importing numpy, {unit:.2f} s')
    print('| instance | rows | building | choosing | in seconds | gain, nats | gap, nats |')
    print('|--:|--:|--:|--:|--:|--:|--:|')
    missed = 0
    for seed in range(options.instances):
        drawn = instance(seed, options.hypotheses)
        began = time.perf_counter()
        model = mirror_model(*drawn, LISTENERS[options.listener], 1.0)
        built = time.perf_counter()
        found = most_informative(model.evidence(), options.n, Question.selection_budget)
        done = time.perf_counter()
        missed += found.gap >= 0.1 or done - built > Question.selection_budget
        cells = [
            seed,
            len(model.ratios),
            f'{(built - began) / unit:.1f}',
            f'{(done - built) / unit:.1f}',
            f'{done - built:.2f}',
            f'{found.information_gain:.3f}',
            f'{found.gap:.3f}',
        ]
        print(f'| {" | ".join(map(str, cells))} |')
    return int(missed > options.instances / 10)


def instance(seed: int, hypotheses: int) -> tuple[Prior, dict[Belief, BeliefPlans], Way]:
    """What a mirror model as described above is made of; the same for the same seed."""
    random = Random(seed)
    parts = [Part(f'p{i}', None) for i in range(ENDS)]
    every = [*itertools.combinations(parts, PARTS)]
    goals = random.sample(every, GOALS)
    achieving = {part: f'(end {part.meaning})' for part in parts}
    means = [f'(means m{i})' for i in range(STEPS - PARTS)]
    steps = [*means, *(achieving[part] for part in goals[0])]
    truth = {part: [False] * (STEPS + 1) for part in parts}
    for position, step in enumerate(steps):
        for part in goals[0]:
            if achieving[part] == step:
                truth[part][position + 1 :] = [True] * (STEPS - position)
    many = hypotheses // GOALS
    beliefs = [
        Belief(goal, frozenset([f'(f{index})'])) for goal in range(GOALS) for index in range(many)
    ]
    weights = [random.random() for _ in beliefs]
    total = sum(weights)
    masses = [
        sum(w for b, w in zip(beliefs, weights, strict=True) if b.goal == goal) / total
        for goal in range(GOALS)
    ]
    results = {
        belief: BeliefPlans(
            Status.SOLVED,
            (
                Plan(
                    (
                        *(achieving[part] for part in goals[belief.goal]),
                        *random.sample(means, len(means) // 2),
                    ),
                    1.0,
                ),
            ),
        )
        for belief in beliefs
    }
    prior = Prior(
        BeliefSpace('', '', ('',) * GOALS),
        tuple(CandidateGoal(str(goal), '', mass) for goal, mass in enumerate(masses)),
        tuple(goals),
        {},
        tuple(beliefs),
        tuple(weight / total for weight in weights),
        0,
        tuple(masses),
        (),
    )
    way = Way(Plan(tuple(steps), 1.0), str, aims(goals, truth, range(STEPS)))
    return prior, results, way


def _seconds_to_import_numpy() -> float:
    began = time.perf_counter()
    subprocess.run([sys.executable, '-c', 'import numpy'], check=True)
    return time.perf_counter() - began


if __name__ == '__main__':
    sys.exit(main())
