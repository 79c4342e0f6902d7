"""Fuzzing led by coverage: what reaches new code in a reader is damaged further.

`scripts/benchmark fuzz_coverage user-model --seconds 600`, with `pip install atheris`. Ends with
an error, and names a file with the text, when something else than an InputError comes out of it.
"""

import argparse
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import atheris

with atheris.instrument_imports(include=['mirror_explainer']):
    from fuzz_readers import (
        MODELS,
        PAIRS,
        PDDL_WORDS,
        PLAN_WORDS,
        PLANS,
        YAML_WORDS,
        try_plan,
        try_task,
        try_user_model,
    )
    from pddl_cases import TOOLS_DOMAIN, TOOLS_PROBLEM, WAREHOUSE_DOMAIN, WAREHOUSE_PROBLEM

    from mirror_explainer.pddl import forget_expressions, read_task

LONGEST = 4000  # bytes of a text
PROBLEM = '(define (problem'  # where the second of a pair of texts begins
HYPOTHESES = b'(holding red_cube), (charged)\n(outside bottom_door)\n'


def plan_reader() -> Callable[[bytes], object]:
    """Return what tries plans."""
    tools = read_task(TOOLS_DOMAIN, TOOLS_PROBLEM)
    return lambda data: try_plan(tools, data.decode('utf-8', 'replace'))


def pddl_reader() -> Callable[[bytes], object]:
    """Return what tries a domain and a problem, one behind the other."""

    def read(data: bytes) -> None:
        forget_expressions()
        domain, begin, problem = data.decode('utf-8', 'replace').partition(PROBLEM)
        try_task(domain, begin + problem)

    return read


def user_model_reader() -> Callable[[bytes], object]:
    """Return what tries user models of the warehouse."""
    warehouse = read_task(WAREHOUSE_DOMAIN, WAREHOUSE_PROBLEM)
    folder = Path(tempfile.mkdtemp())
    return lambda data: try_user_model(warehouse, folder, data, HYPOTHESES)


KINDS = {
    'plan': (plan_reader, PLANS, PLAN_WORDS),
    'pddl': (pddl_reader, [domain + problem for domain, problem in PAIRS], PDDL_WORDS),
    'user-model': (user_model_reader, MODELS, YAML_WORDS),
}


def write_corpus(folder: Path, texts: Sequence[str], words: Sequence[str]) -> tuple[Path, Path]:
    """Write the texts to begin with, and a dictionary of words, as libFuzzer reads them."""
    corpus = folder / 'corpus'
    corpus.mkdir(parents=True, exist_ok=True)
    for number, text in enumerate(texts):
        (corpus / f'seed{number}').write_text(text)
    dictionary = folder / 'words'
    quoted = [''.join(f'\\x{byte:02X}' for byte in word.encode()) for word in words]
    dictionary.write_text(''.join(f'"{word}"\n' for word in quoted))
    return corpus, dictionary


def main() -> None:
    """Fuzz one reader for some time."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('kind', choices=KINDS)
    parser.add_argument('--seconds', type=int, default=600)
    parser.add_argument('--folder', type=Path, help='what was found is kept here')
    options = parser.parse_args()
    make_reader, texts, words = KINDS[options.kind]
    folder = options.folder or Path(tempfile.mkdtemp(prefix='fuzz_'))
    corpus, dictionary = write_corpus(folder, texts, words)
    libfuzzer = {
        'dict': dictionary,
        'artifact_prefix': f'{folder}/failed_',
        'max_len': LONGEST,
        'max_total_time': options.seconds,
        'timeout': 20,
    }
    flags = [f'-{name}={value}' for name, value in libfuzzer.items()]
    atheris.Setup([sys.argv[0], str(corpus), *flags], make_reader())
    atheris.Fuzz()


if __name__ == '__main__':
    main()
