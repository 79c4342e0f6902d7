"""Damaged texts by the hundred thousand: `scripts/benchmark fuzz_reader [KIND] [--cases N]`.

Real tasks (by default), plans or user models are damaged at random. What is read must be as
the tests of fuzzing have it; all else must be refused with a place. Prints how many were taken,
what crashed, and the slowest. Exit status 1 if something crashed, or took more than a second of
processor time.
"""

import argparse
import gc
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

from fuzz_readers import (
    MODELS,
    PAIRS,
    PLAN_WORDS,
    PLANS,
    YAML_WORDS,
    damaged_pairs,
    try_plan,
    try_task,
    try_user_model,
)
from fuzzing import NOISE, Watch, damaged
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st
from pddl_cases import TOOLS_DOMAIN, TOOLS_PROBLEM, WAREHOUSE_DOMAIN, WAREHOUSE_PROBLEM

from mirror_explainer.pddl import forget_expressions, read_task

MOST_SECONDS = 1.0
MOST_SHOWN = 5


def tasks() -> tuple[st.SearchStrategy[tuple[str, ...]], Callable[..., bool]]:
    """Return domains with problems, and what reads them."""

    def read(domain: str, problem: str) -> bool:
        forget_expressions()
        return try_task(domain, problem)

    read(*PAIRS[0])  # what unified-planning imports to read a task takes a second
    return damaged_pairs(), read


def plans() -> tuple[st.SearchStrategy[tuple[str, ...]], Callable[..., bool]]:
    """Return plans, and what reads them."""
    tools = read_task(TOOLS_DOMAIN, TOOLS_PROBLEM)
    texts = damaged(PLANS, PLAN_WORDS) | NOISE
    return st.tuples(texts), lambda text: try_plan(tools, text)


def user_models() -> tuple[st.SearchStrategy[tuple[str, ...]], Callable[..., bool]]:
    """Return user models of the warehouse with hypotheses, and what reads them."""
    warehouse = read_task(WAREHOUSE_DOMAIN, WAREHOUSE_PROBLEM)
    folder = Path(tempfile.mkdtemp())

    def read(text: str, hypotheses: str) -> bool:
        model = text.encode('utf-8', 'surrogatepass')
        return try_user_model(warehouse, folder, model, hypotheses.encode('utf-8', 'replace'))

    return st.tuples(damaged(MODELS, YAML_WORDS) | NOISE, NOISE), read


KINDS = {'tasks': tasks, 'plans': plans, 'user-models': user_models}


def fuzz(kind: str, cases: int, number: int) -> bool:
    """Let so many texts be read, and say whether all went well."""
    strategy, read = KINDS[kind]()
    watch, crashes = Watch(), []

    @seed(number)
    @settings(
        max_examples=cases,
        deadline=None,
        database=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(texts=strategy)
    def run(texts: tuple[str, ...]) -> None:
        if watch.cases % 200 == 0:  # what Hypothesis keeps is no garbage that a reader makes
            gc.collect()
            gc.freeze()
        try:
            watch.over('\n'.join(texts), lambda: read(*texts))
        except Exception as error:  # whatever comes of a text is to be told, and the next read
            crashes.append((texts, error))

    started = time.process_time()
    run()
    seconds = time.process_time() - started
    print(f'{kind}: {watch.cases} texts in {seconds:.0f} s, {watch.taken} taken,', end=' ')
    print(f'{len(crashes)} crashed, the slowest took {watch.slowest:.3f} s')
    for texts, error in crashes[:MOST_SHOWN]:
        print(f'{type(error).__name__}: {error}\n{texts!r}')
    if watch.slowest > MOST_SECONDS:
        print(repr(watch.slowest_text))
    return not crashes and watch.slowest <= MOST_SECONDS


def main() -> int:
    """Fuzz a reader; return 1 if something is wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('kind', nargs='?', default='tasks', choices=KINDS)
    parser.add_argument('--cases', type=int, default=100_000)
    parser.add_argument('--seed', type=int, default=1)
    options = parser.parse_args()
    warnings.simplefilter('ignore')  # of unified-planning's reader
    return int(not fuzz(options.kind, options.cases, options.seed))


if __name__ == '__main__':
    sys.exit(main())
