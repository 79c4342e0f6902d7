"""The pages: welcome, practice, scenarios step by step, and one's own result.

One address, /study, always shows what the participant is to do next, so that reloading,
going back, or coming again tomorrow leads there.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any
from urllib.parse import quote

from django.http import HttpRequest, HttpResponse, HttpResponseRedirect
from django.shortcuts import render

from mirror_explainer.experiments.study.design import DONT_KNOW
from mirror_explainer.experiments.study.web_study import own_result, records
from mirror_explainer.experiments.study.web_study.design import (
    PRACTICE,
    Choice,
    Design,
    Encounter,
    from_json,
)
from mirror_explainer.experiments.study.web_study.drawing import Drawing, drawing, look
from mirror_explainer.experiments.study.web_study.models import Participant, Study
from mirror_explainer.experiments.study.web_study.progress import (
    Due,
    Outcome,
    answer,
    begin,
    due,
    enter,
    is_code,
    minutes_left,
    new_code,
    show,
    turns_of,
)
from mirror_explainer.experiments.study.web_study.study_file import StudyFile
from mirror_explainer.experiments.study.web_study.texts import LANGUAGES, Words, words
from mirror_explainer.pddl import read_task

_COOKIE = 'study_participant'
_COOKIE_AGE = 180 * 24 * 3600  # s
_LONGEST_PARAMETER = 200  # letters
_LONGEST_COMMENT = 4000


@cache
def _design() -> Design:
    return from_json(Study.objects.get().design)


@cache
def _study() -> StudyFile:
    return StudyFile.model_validate_json(Study.objects.get().texts)


@cache
def _drawing(encounter: str, language: str) -> Drawing:
    problem = _design().encounter(encounter).problem
    task = read_task(_design().domain, problem, problem_source=encounter)
    return drawing(task, words(language))


def welcome(request: HttpRequest) -> HttpResponse:
    """Say who asks and what is kept, and ask for consent."""
    return _welcome(request)


def join(request: HttpRequest) -> HttpResponse:
    """Let somebody take part who agrees to."""
    code, language = request.POST.get('new', ''), _language(request.POST)
    if 'consent' not in request.POST or not is_code(code):
        return _welcome(request, words(language).text('tick'))
    return _as_participant(enter(_design(), code, language, _kept(request.POST)).code)


def resume(request: HttpRequest) -> HttpResponse:
    """Let somebody go on in another browser, by their code."""
    code = request.POST.get('code', '').strip().lower()
    if not Participant.objects.filter(code=code).exists():
        said = words(_language(request.POST))
        return _welcome(
            request, said.text('no_code', code=code) if code else said.text('give_code')
        )
    return _as_participant(code)


def study(request: HttpRequest) -> HttpResponse:
    """Show what is to be done next."""
    participant = _participant(request)
    if participant is None:
        return HttpResponseRedirect('/')
    return _next(request, participant)


def start(request: HttpRequest) -> HttpResponse:
    """Begin the scenario that is next: the time of its first step runs from here."""
    participant = _participant(request)
    next_ = due(participant, _design()) if participant else None
    if participant and next_ and not next_.begun and not _is_checked(participant, next_):
        begin(participant, next_)
    return HttpResponseRedirect('/study')


def give(request: HttpRequest) -> HttpResponse:
    """Keep an answer, and go on."""
    participant = _participant(request)
    if participant is None:
        return HttpResponseRedirect('/')
    values = (request.POST.get(n, '') for n in ('scenario', 'step', 'choice', 'in_browser'))
    outcome = answer(participant, _design(), *values)
    if outcome is Outcome.KEPT:
        return HttpResponseRedirect('/study')
    key = 'stale' if outcome is Outcome.STALE else 'choose'
    return _next(request, participant, words(participant.language).text(key))


def check(request: HttpRequest) -> HttpResponse:
    """Take the answers to the questions after the practice; wrong ones are asked again."""
    participant = _participant(request)
    if participant is None:
        return HttpResponseRedirect('/')
    said = words(participant.language)
    given = [request.POST.get(f'check-{i}', '') for i in range(len(said.checks))]
    next_ = due(participant, _design())
    if next_ is None or not _is_checked(participant, next_):
        return HttpResponseRedirect('/study')
    if not all(given):
        return _checks(request, participant, next_, said.text('check_choose'))
    wrong = [i for i, one in enumerate(said.checks) if given[i] != str(one.right)]
    participant.checks += 1
    participant.checked = not wrong
    participant.save(update_fields=['checks', 'checked'])
    if wrong:
        return _checks(request, participant, next_, '', wrong)
    return HttpResponseRedirect('/study')


def close(request: HttpRequest) -> HttpResponse:
    """Take the last page: questions and comment."""
    participant = _participant(request)
    if participant is None:
        return HttpResponseRedirect('/')
    if due(participant, _design()) is not None:
        return HttpResponseRedirect('/study')
    said = words(participant.language)
    given = {'': request.POST.get('comment', '')[:_LONGEST_COMMENT]}
    for question in _study().questions:
        value = request.POST.get(f'question-{question.name}', '').strip()[:_LONGEST_COMMENT]
        if question.kind == 'number' and value and not _is_number(value):
            return _closing(request, participant, said.text('not_number', value=value), given)
        if question.kind == 'choice' and value:
            index = int(value) if value.isdecimal() and len(value) < 4 else -1
            options = question.options
            value = _study().text(options[index], _first()) if 0 <= index < len(options) else ''
        given[question.name] = value
    participant.closing = given
    participant.save(update_fields=['closing'])
    return HttpResponseRedirect('/study')


def leave(request: HttpRequest) -> HttpResponse:
    """Let a participant stop: for now, for somebody else, or with all answers deleted."""
    participant = _participant(request)
    if participant is None:
        return HttpResponseRedirect('/')
    if request.method != 'POST':
        return render(request, 'study/leave.html', _frame(participant))
    if request.POST.get('answers') == 'delete':
        participant.delete()
    response = HttpResponseRedirect('/')
    response.delete_cookie(_COOKIE, samesite='Lax')
    return response


def _next(request: HttpRequest, participant: Participant, error: str = '') -> HttpResponse:
    next_ = due(participant, _design())
    if next_ is None:
        if not records.has_finished(participant, _design(), _study()):
            return _closing(request, participant)
        return _result(request, participant)
    if _is_checked(participant, next_):
        return _checks(request, participant, next_, error)
    if next_.begun:
        return _step(request, participant, next_, error)
    context = {
        **_frame(participant),
        'due': next_,
        'error': error,
        'drawing': _drawing(PRACTICE, participant.language),
    }
    return render(request, 'study/before.html', context, status=400 if error else 200)


def _is_checked(participant: Participant, next_: Due) -> bool:
    """Whether the questions after the practice are what is to be done."""
    return next_.place > 0 and not participant.checked


def _welcome(request: HttpRequest, error: str = '') -> HttpResponse:
    sent = request.POST if request.method == 'POST' else request.GET
    language, study_ = _language(sent), _study()
    kept = _kept(sent)
    context = {
        **_texts(language),
        'participant': _participant(request),
        'study': study_,
        'purpose': study_.text(study_.purpose, language),
        'consent': study_.text(study_.consent, language),
        'kept': kept,
        'others': [
            (words(other), '&'.join(f'{n}={quote(v)}' for n, v in kept.items()))
            for other in study_.languages
            if other != language and other in LANGUAGES
        ],
        'error': error,
        'new_code': new_code(),
    }
    return render(request, 'study/welcome.html', context, status=400 if error else 200)


def _step(
    request: HttpRequest, participant: Participant, next_: Due, error: str = ''
) -> HttpResponse:
    show(participant, next_)
    said = words(participant.language)
    names = [choice.name for choice in next_.choices]
    last = '?' if next_.last == DONT_KNOW else ''
    choices = [_choice(choice, said) for choice in next_.choices]
    same = said.text('dont_know')
    if next_.last in names:
        last = str(names.index(next_.last))
        same = choices[int(last)][0]
    context = {
        **_frame(participant),
        'due': next_,
        'drawing': _drawing(next_.encounter.name, participant.language),
        'sentences': [_sentence(next_.encounter, position, said) for position in next_.said],
        'choices': choices,
        'last': last,
        'same': same,
        'error': error,
    }
    return render(request, 'study/step.html', context, status=400 if error else 200)


def _checks(
    request: HttpRequest,
    participant: Participant,
    next_: Due,
    error: str = '',
    wrong: tuple[int, ...] | list[int] = (),
) -> HttpResponse:
    """Tell how the practice went, and ask whether the rules are clear."""
    said, practice = words(participant.language), _design().practice
    strategy = turns_of(participant)[0].strategy
    given = {
        each.step: each.answer for each in participant.step_set.filter(scenario=practice.name)
    }
    context = {
        **_frame(participant),
        'goal': _goal(practice.true_choice, said),
        'told': [
            (
                _sentence(practice, position, said),
                _mark(given.get(step), practice.goal),
            )
            for step, position in enumerate(practice.orders[strategy], start=1)
        ],
        'checks': [(index, one, index in wrong) for index, one in enumerate(said.checks)],
        'error': error,
    }
    return render(request, 'study/checks.html', context, status=400 if error or wrong else 200)


def _closing(
    request: HttpRequest,
    participant: Participant,
    error: str = '',
    given: Mapping[str, str] | None = None,
) -> HttpResponse:
    language, study_ = participant.language, _study()
    context = {
        **_frame(participant),
        'questions': [
            (q, study_.text(q.question, language), [study_.text(o, language) for o in q.options])
            for q in study_.questions
        ],
        'ask_comment': study_.closing_comment,
        'comment': (given or {}).get('', ''),
        'error': error,
    }
    return render(request, 'study/closing.html', context, status=400 if error else 200)


def _result(request: HttpRequest, participant: Participant) -> HttpResponse:
    design, said = _design(), words(participant.language)
    met = own_result.encountered(list(records.answers(participant, design)))
    drawn = own_result.chart(met, design.sure_after)
    completion = _study().completion
    return_to = completion.return_to
    for name in _study().keep_parameters:
        value = quote(participant.parameters.get(name, ''), safe='')
        return_to = return_to.replace(f'{{{name}}}', value)
    context = {
        **_frame(participant),
        'chart': drawn,
        'how_soon': {row.strategy: _how_soon(row, said) for row in drawn.rows},
        'rows': [(said.text(row.strategy), _how_soon(row, said), row) for row in drawn.rows],
        'met': [
            (
                _goal(design.encounter(each.scenario).true_choice, said),
                said.text(each.strategy),
                each.marks,
            )
            for each in met
        ],
        'completion_code': completion.code,
        'return_to': return_to,
    }
    return render(request, 'study/result.html', context)


def _how_soon(row: own_result.Row, said: Words) -> str:
    """Return after how many sentences a participant was sure, and in how many scenarios."""
    if row.mean is None:
        return said.text('never') if row.met else said.text('no_number')
    mean = f'{row.mean:.1f}'.removesuffix('.0')
    if row.sure == row.met:
        return mean
    return said.text('sure_in', mean=mean, sure=row.sure, met=row.met)


def _frame(participant: Participant) -> dict[str, Any]:
    """Return what every page of a participant has."""
    done, minutes = minutes_left(participant, _design(), _study().minutes)
    return {
        **_texts(participant.language),
        'participant': participant,
        'encounters': len(participant.turns) - 1,
        'percent': round(100 * done),
        'minutes_left': minutes,
    }


def _texts(language: str) -> dict[str, Any]:
    said, study_ = words(language), _study()
    return {'words': said, 'study_title': study_.text(study_.title, language)}


def _first() -> str:
    """Return the study's first language, in which answers are kept."""
    return _study().languages[0]


def _language(sent: Mapping[str, Any]) -> str:
    """Return the language that is asked for, or else the study's first."""
    asked = sent.get('language', '')
    return asked if asked in _study().languages else _first()


def _kept(sent: Mapping[str, Any]) -> dict[str, str]:
    """Return those parameters of an address or form that the study keeps."""
    return {
        name: sent[name][:_LONGEST_PARAMETER] for name in _study().keep_parameters if name in sent
    }


def _sentence(encounter: Encounter, position: int, said: Words) -> str:
    sentence = encounter.sentences[position]
    actions = encounter.actions
    return said.said(actions[position], sentence) if actions else sentence


def _goal(choice: Choice, said: Words) -> str:
    """Return a goal as a participant reads it."""
    if not choice.things:
        return choice.name
    first, second, door = map(said.thing, choice.things)
    goal = said.text('goal', first=first, second=second, door=door)
    return goal[0].upper() + goal[1:]


def _choice(choice: Choice, said: Words) -> tuple[str, list[tuple[str, str]]]:
    """Return a goal's words, and shape and colour of its items."""
    return _goal(choice, said), [look(item) for item in choice.things[:-1]]


def _mark(answer: str | None, goal: str) -> str:
    if answer is None or answer == DONT_KNOW:
        return 'unknown'
    return 'right' if answer == goal else 'wrong'


def _is_number(value: str) -> bool:
    try:
        float(value.replace(',', '.'))
    except ValueError:
        return False
    return True


def _participant(request: HttpRequest) -> Participant | None:
    code = request.COOKIES.get(_COOKIE, '')
    participant: Participant | None = Participant.objects.filter(code=code).first()
    return participant


def _as_participant(code: str) -> HttpResponse:
    response = HttpResponseRedirect('/study')
    response.set_cookie(_COOKIE, code, max_age=_COOKIE_AGE, httponly=True, samesite='Lax')
    return response
