"""How fast the selection is, beside enumeration in the same run.

Not collected with the tests: run `pytest test/benchmarks/selection.py`. Every
line it prints is one measurement in words; pytest-benchmark's table follows.
"""

import itertools
import math
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from mirror_explainer.listener.mirror_model import Evidence
from mirror_explainer.selection.algorithm import Selection, curve, most_informative

Report = Callable[[str], None]


@pytest.fixture
def report(capsys) -> Report:
    """Print a line of the table at once, whatever pytest captures."""

    def printed(line: str) -> None:
        with capsys.disabled():
            print('\n' + line, end='', flush=True)

    return printed


def plans(
    seed: int,
    actions: int = 100,
    hypotheses: int = 100,
    pool: int = 1000,
    shares: tuple[float, float] = (0.1, 0.9),
) -> Evidence:
    """Evidence of plans that share a random part of the robot's sentences.

    The robot's actions are drawn from a pool of sentences, repetitions
    included; other plans have each sentence of the robot's with a probability
    of their own between `shares`, as often or once more or less often, and
    lengths of their own: r = (count_k / length_k) / (count_R / length_R).
    """
    random = np.random.default_rng(seed)
    _, sentence, count = np.unique(
        random.integers(0, pool, actions), return_inverse=True, return_counts=True
    )
    ratio = [np.ones(len(count))]
    while len(ratio) < hypotheses:
        share = random.uniform(*shares)
        has = random.random(len(count)) < share
        counts = has * np.maximum(1, count + random.integers(-1, 2, len(count)))
        length = max(counts.sum(), 1) + random.integers(0, 1 + int((1 - share) * 1.5 * actions))
        ratio.append((counts / length) / (count / actions))
    return Evidence(
        prior=random.dirichlet(np.ones(hypotheses)),
        ratio=np.array(ratio)[:, sentence],
        positions=np.arange(actions),
    )


def unstructured(seed: int, hypotheses: int, kind: str) -> Evidence:
    """Evidence of 100 positions, every ratio drawn by itself: nothing to hold on to."""
    random = np.random.default_rng(seed)
    shape = (hypotheses, 100)
    ratio = {
        'any ratio in 0..1': lambda: random.random(shape),
        'has it with p = 0.5': lambda: 1.0 * (random.random(shape) < 0.5),
        'has it with p = 0.8': lambda: 1.0 * (random.random(shape) < 0.8),
        'p = 0.8, ratio 0.3..2': lambda: (
            (random.random(shape) < 0.8) * random.uniform(0.3, 2.0, shape)
        ),
    }[kind]()
    ratio[0] = 1.0
    return Evidence(random.dirichlet(np.ones(hypotheses)), ratio, np.arange(100))


def as_written(evidence: Evidence, n: int) -> float:
    """FIND-MOST-INFORMATIVE, line by line: the gain of every combination, sorted."""
    queue = []
    for combination in itertools.combinations(range(len(evidence.positions)), n):
        queue.append((evidence.information_gain(combination), combination))
    queue.sort()
    gain, _ = queue.pop()
    return gain


def vectorised(evidence: Evidence, n: int) -> float:
    """The largest gain of all, enumerated as products of matrices: halves against halves.

    Every set of six is a triple and a triple whose positions all come later.
    """
    half = np.array(list(itertools.combinations(range(len(evidence.positions)), n // 2)))
    products = evidence.ratio[:, half].prod(axis=2)  # (K, C)
    weighted = evidence.prior[:, None] * products
    least = math.inf
    for first in range(int(half[:, -1].max()) + 1):
        ending = half[:, -1] == first
        later = half[:, 0] > first
        if ending.any() and later.any():
            least = min(least, float((weighted[:, ending].T @ products[:, later]).min()))
    return -math.log(least)


def timed(call: Callable[[Evidence, int], float], evidence: Evidence, n: int) -> float:
    """Seconds that one call takes."""
    started = time.perf_counter()
    call(evidence, n)
    return time.perf_counter() - started


@pytest.mark.parametrize('seed', range(3))
def test_six_of_36_beside_enumeration(benchmark, report, seed):
    """C(36, 6) = 1,947,792 combinations."""
    evidence = plans(seed, actions=36)

    ours = benchmark(lambda: most_informative(replace(evidence), 6))  # nothing tabulated before

    started = time.perf_counter()
    gain = as_written(evidence, 6)
    written = time.perf_counter() - started
    products = min(timed(vectorised, evidence, 6) for _ in range(3))
    assert ours.information_gain == pytest.approx(gain, abs=1e-9)
    median = benchmark.stats.stats.median
    report(
        f'6 of 36, seed {seed}: ours {median * 1e3:.1f} ms; Algorithm 1 as written '
        f'{written:.1f} s ({written / median:,.0f} times); '
        f'as matrix products {products:.2f} s ({products / median:,.0f} times); same gain.'
    )


@pytest.mark.parametrize(
    ('name', 'pool', 'shares'),
    [
        ('share 10-90 %, few repeats', 1000, (0.1, 0.9)),
        ('share 10-90 %, many repeats', 100, (0.1, 0.9)),
        ('share 10-90 %, 30 sentences', 30, (0.1, 0.9)),
        ('share 50 %', 1000, (0.5, 0.5)),
        ('share 70 %', 1000, (0.7, 0.7)),
        ('share 80 %', 1000, (0.8, 0.8)),
    ],
)
@pytest.mark.parametrize('seed', range(3))
def test_any_n_of_100_actions_against_100_hypotheses(benchmark, report, name, pool, shares, seed):
    """Every N by itself, at most 0.5 s each, and the whole curve."""
    evidence = plans(seed, pool=pool, shares=shares)

    def every() -> dict[int, tuple[float, Selection]]:
        found = {}
        for n in range(1, 101):
            started = time.perf_counter()
            selection = most_informative(replace(evidence), n, budget=0.5)
            found[n] = (time.perf_counter() - started, selection)
        return found

    single = every()
    benchmark.pedantic(curve, args=(replace(evidence), 10.0), rounds=1)

    times = sorted(t for t, _ in single.values())
    slow = [n for n, (t, _) in single.items() if t > 0.1]
    gaps = {n: round(s.gap, 2) for n, (_, s) in single.items() if not s.optimal}
    report(
        f'{name}, seed {seed}: any N median {times[50] * 1e3:.0f} ms, worst '
        f'{times[-1] * 1e3:.0f} ms, over 100 ms: {slow or "none"}; '
        f'gap left at 0.5 s: {gaps or "none"}; curve {benchmark.stats.stats.max:.2f} s'
    )


@pytest.mark.parametrize(
    'kind',
    [
        'any ratio in 0..1',
        'has it with p = 0.5',
        'has it with p = 0.8',
        'p = 0.8, ratio 0.3..2',
    ],
)
def test_stress_of_1000_unstructured_hypotheses(benchmark, report, kind):
    """N = 8 within the default budget, and what a much longer run would have brought."""
    evidence = unstructured(1, 1000, kind)

    ours = benchmark.pedantic(most_informative, args=(evidence, 8, 0.5), rounds=1)
    longer = most_informative(evidence, 8, 60.0)

    assert longer.information_gain <= ours.information_gain + ours.gap + 1e-9
    report(
        f'stress, {kind}: {benchmark.stats.stats.max:.2f} s, gain {ours.information_gain:.4f} '
        f'(gap {ours.gap:.2f}); after 60 s {longer.information_gain:.4f} (gap {longer.gap:.2f})'
    )


@pytest.mark.parametrize('n', [4, 5])
def test_stress_where_the_optimum_can_be_had(benchmark, report, n):
    """Small N of the stress: the best found in the budget, and the optimum."""
    evidence = unstructured(1, 1000, 'any ratio in 0..1')

    ours = benchmark.pedantic(most_informative, args=(evidence, n, 0.5), rounds=1)
    started = time.perf_counter()
    optimum = most_informative(evidence, n, 300.0)

    report(
        f'stress, N = {n}: {benchmark.stats.stats.max:.2f} s, gain {ours.information_gain:.6f} '
        f'(gap {ours.gap:.2f}); {"optimum" if optimum.optimal else "best"} '
        f'{optimum.information_gain:.6f} after {time.perf_counter() - started:.0f} s'
    )
