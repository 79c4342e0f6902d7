"""What a researcher writes of a study: study.yaml, its form, and what is wrong with one.

All is optional: without a file the study is the paper's, for whoever opens the address.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from mirror_explainer.errors import did_you_mean
from mirror_explainer.experiments.study.plans import LEAST_SCENARIOS
from mirror_explainer.experiments.study.web_study.texts import LANGUAGES
from mirror_explainer.listener.user_model_file import (
    Fault,
    faults_error,
    parse_yaml,
    schema_fault,
    text_faults,
)
from mirror_explainer.text_files import read_text

DEFAULT_LANGUAGE = 'en'
_Path = tuple[str | int, ...]


class _Section(BaseModel):
    model_config = ConfigDict(extra='forbid', strict=True, frozen=True)


_Text = Annotated[str, Field(min_length=1, pattern=r'\S')]
_Name = Annotated[str, Field(pattern=r'^[A-Za-z][A-Za-z0-9_-]{0,39}$')]


def _by_language(value: object) -> object:
    return {'': value} if isinstance(value, str) else value


# A text for all languages, by '', or one for each.
_Texts = Annotated[dict[str, _Text], Field(min_length=1), BeforeValidator(_by_language)]


class Question(_Section):
    """Something that is asked in the end; nobody has to answer it."""

    name: _Name
    question: _Texts
    kind: Literal['text', 'number', 'choice'] = 'text'
    options: list[_Texts] = []


class Completion(_Section):
    """What those who finish are given: a code to note, an address to return to, or both.

    `{NAME}` in the address stands for the parameter of this name that was kept.
    """

    code: str = ''
    return_to: Annotated[str, Field(pattern=r'^(https?://\S+)?$')] = ''


class StudyFile(_Section):
    """The file's schema. Texts but the title are Markdown."""

    title: _Texts = {'en': 'What is the robot up to?', 'de': 'Was hat der Roboter vor?'}
    purpose: _Texts | None = None
    researcher: str = ''
    contact: str = ''
    consent: _Texts | None = None
    minutes: Annotated[int, Field(ge=1, le=240)] = 20
    minimum_age: Annotated[int, Field(ge=1, le=120)] | None = None
    languages: Annotated[list[str], Field(min_length=1)] = [DEFAULT_LANGUAGE]
    questions: list[Question] = []
    closing_comment: bool = False
    keep_parameters: list[_Name] = []
    completion: Completion = Completion()
    # Fixed once the study has begun; None: as usual.
    scenarios: Annotated[int, Field(ge=LEAST_SCENARIOS, le=100)] | None = None
    seed: Annotated[int, Field(ge=0)] | None = None
    listeners: Annotated[list[Literal['planner', 'open']], Field(min_length=1)] | None = None

    def text(self, texts: Mapping[str, str] | None, language: str) -> str:
        """Return a text in a language, '' where there is none."""
        if not texts:
            return ''
        return texts.get(language) or texts.get('') or next(iter(texts.values()))


_SECTIONS: Mapping[str, type[BaseModel]] = {'questions': Question, 'completion': Completion}


def read_study_file(path: Path) -> StudyFile:
    """Return the study that a file describes. Raises one InputError with all its faults."""
    source = str(path)
    wanted = 'the study must be a mapping, with lines such as "title: What is it up to?"'
    root, data = parse_yaml(read_text(source), source, wanted)
    faults = list(text_faults(root))
    study = None
    try:
        study = StudyFile.model_validate(data)
    except ValidationError as error:
        faults += map(_fault, error.errors())
    faults += _language_faults(data)
    faults += _question_faults(data)
    if faults or study is None:
        raise faults_error(source, faults, root)
    return study


def _fault(detail: Any) -> Fault:
    """Return a validation error in plain words, and its place."""
    place: _Path = tuple(part for part in detail['loc'] if part != '')
    kind, last = detail['type'], place[-1] if place else ''
    if kind == 'extra_forbidden':
        section = _SECTIONS.get(str(place[0]), StudyFile) if len(place) > 1 else StudyFile
        return Fault(place, 'unknown key' + did_you_mean(str(last), section.model_fields))
    if last == 'return_to' and kind == 'string_pattern_mismatch':
        return Fault(place, 'this should be an address that begins with https:// or http://')
    if kind == 'string_pattern_mismatch' and detail['ctx']['pattern'].startswith('^[A-Za-z]'):
        reason = 'a name here has up to 40 letters from A to Z, digits, "_" and "-"'
        return Fault(place, f'"{detail["input"]}" is no name: {reason}')
    if kind == 'dict_type':
        return Fault(place, 'this should be a text, or one for each language: {en: …, de: …}')
    return schema_fault({**detail, 'loc': place})


def _language_faults(data: Mapping[str, Any]) -> Iterator[Fault]:
    """Find languages that there is no catalogue of, and texts that lack one of the study's."""
    languages = data.get('languages', [DEFAULT_LANGUAGE])
    if not isinstance(languages, list):
        return
    for index, language in enumerate(languages):
        if isinstance(language, str) and language not in LANGUAGES:
            have = ', '.join(LANGUAGES)
            yield Fault(('languages', index), f'there are no texts in "{language}", but in {have}')
    for place, texts in _localised(data):
        missing = [language for language in languages if language not in texts]
        if missing:
            yield Fault(place, f'it lacks the text in {", ".join(map(str, missing))}')


def _localised(data: Mapping[str, Any]) -> Iterator[tuple[_Path, Mapping[str, Any]]]:
    """Yield every mapping of languages to texts, with its place."""
    candidates: list[tuple[_Path, Any]] = [
        ((name,), data.get(name)) for name in ('title', 'purpose', 'consent')
    ]
    for index, question in enumerate(_questions(data)):
        candidates.append((('questions', index, 'question'), question.get('question')))
        options = question.get('options')
        for number, option in enumerate(options if isinstance(options, list) else ()):
            candidates.append((('questions', index, 'options', number), option))
    for place, value in candidates:
        if isinstance(value, dict):
            yield place, value


def _question_faults(data: Mapping[str, Any]) -> Iterator[Fault]:
    """Find questions that are named alike, and choices without, or options without a choice."""
    names: set[Any] = set()
    for index, question in enumerate(_questions(data)):
        name = question.get('name')
        if isinstance(name, str):
            if name in names:
                yield Fault(('questions', index), f'another question is named "{name}" too')
            names.add(name)
        choice, options = question.get('kind') == 'choice', question.get('options')
        if choice and not (isinstance(options, list) and len(options) > 1):
            yield Fault(('questions', index), 'a choice needs "options", two or more')
        elif options and not choice:
            reason = 'options are for a question of "kind: choice" only'
            yield Fault(('questions', index, 'options'), reason)


def _questions(data: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the questions that are mappings, those that are none as empty ones."""
    found = data.get('questions')
    return [q if isinstance(q, dict) else {} for q in found] if isinstance(found, list) else []
