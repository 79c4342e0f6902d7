"""The phrases: what the documentation says of them."""

from dataclasses import fields
from pathlib import Path

from mirror_explainer.listener.phrases import Phrases

DOCS = Path(__file__).parents[2] / 'docs' / 'user_model.md'


def test_the_documentation_has_every_phrase_with_its_default() -> None:
    rows = {
        f'| `{each.name.rstrip("_")}` | {each.default} | {each.metadata["when"]} |'
        for each in fields(Phrases)
    }

    assert rows <= set(DOCS.read_text(encoding='utf-8').splitlines())


def test_no_phrase_names_a_topic_or_a_file() -> None:
    assert not [p for p in vars(Phrases()).values() if any(sign in p for sign in '/_')]


def test_a_user_model_that_sets_the_word_for_others_need_not_set_that_for_one() -> None:
    assert Phrases.of({'others': 'andere'}).other == 'andere'
    assert Phrases.of({'others': 'andere', 'other': 'eins mehr'}).other == 'eins mehr'
    assert Phrases.of({'and': 'und'}).other == 'one more'
