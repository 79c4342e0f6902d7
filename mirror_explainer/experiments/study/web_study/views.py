"""The pages: welcome, practice, scenarios step by step, and one's own result.

One address, /study, always shows what the participant is to do next, so that reloading,
going back, or coming again tomorrow leads there.
"""

from functools import cache
from typing import Any

from django.http import HttpRequest, HttpResponse, HttpResponseRedirect
from django.shortcuts import render

from mirror_explainer.experiments.study.web_study import own_curve, records
from mirror_explainer.experiments.study.web_study.design import PRACTICE, Design, from_json
from mirror_explainer.experiments.study.web_study.drawing import Drawing, drawing
from mirror_explainer.experiments.study.web_study.models import Participant, Study
from mirror_explainer.experiments.study.web_study.progress import (
    Due,
    answer,
    begin,
    due,
    enter,
    is_code,
    new_code,
    show,
)
from mirror_explainer.pddl import read_task
from mirror_explainer.settings import STRATEGIES

_COOKIE = 'study_participant'
_COOKIE_AGE = 180 * 24 * 3600  # s


@cache
def _design() -> Design:
    return from_json(Study.objects.get().design)


@cache
def _drawing(encounter: str) -> Drawing:
    problem = _design().encounter(encounter).problem
    return drawing(read_task(_design().domain, problem, problem_source=encounter))


def welcome(request: HttpRequest) -> HttpResponse:
    """Explain the study, and ask for consent."""
    return _welcome(request)


def join(request: HttpRequest) -> HttpResponse:
    """Let somebody take part who agrees to."""
    code = request.POST.get('new', '')
    if 'consent' not in request.POST or not is_code(code):
        return _welcome(request, 'Tick the box if you agree; without that you cannot take part.')
    return _as_participant(enter(_design(), code).code)


def resume(request: HttpRequest) -> HttpResponse:
    """Let somebody go on in another browser, by their code."""
    code = request.POST.get('code', '').strip().lower()
    if not Participant.objects.filter(code=code).exists():
        return _welcome(request, f'Nobody has the code “{code}”.' if code else 'Give your code.')
    return _as_participant(code)


def study(request: HttpRequest) -> HttpResponse:
    """Show what is to be done next."""
    participant = _participant(request)
    if participant is None:
        return HttpResponseRedirect('/')
    next_ = due(participant, _design())
    if next_ is None:
        return _result(request, participant)
    if not next_.begun:
        return render(request, 'study/before.html', _context(participant, next_))
    return _step(request, participant, next_)


def start(request: HttpRequest) -> HttpResponse:
    """Begin the scenario that is next: the time of its first step runs from here."""
    participant = _participant(request)
    next_ = due(participant, _design()) if participant else None
    if participant and next_ and not next_.begun:
        begin(participant, next_)
    return HttpResponseRedirect('/study')


def give(request: HttpRequest) -> HttpResponse:
    """Keep an answer, and go on."""
    participant = _participant(request)
    if participant is None:
        return HttpResponseRedirect('/')
    scenario, step, choice = (
        request.POST.get(name, '') for name in ('scenario', 'step', 'choice')
    )
    kept = answer(participant, _design(), scenario, step, choice)
    next_ = due(participant, _design())
    if kept or next_ is None:
        return HttpResponseRedirect('/study')
    return _step(request, participant, next_, 'Choose one of the four answers.')


def leave(request: HttpRequest) -> HttpResponse:
    """Let a participant stop: for now, for somebody else, or with all answers deleted."""
    participant = _participant(request)
    if participant is None:
        return HttpResponseRedirect('/')
    if request.method != 'POST':
        return render(request, 'study/leave.html', {'participant': participant})
    if request.POST.get('answers') == 'delete':
        participant.delete()
    response = HttpResponseRedirect('/')
    response.delete_cookie(_COOKIE, samesite='Lax')
    return response


def _welcome(request: HttpRequest, error: str = '') -> HttpResponse:
    context = {
        'participant': _participant(request),
        'scenarios': len(_design().encounters),
        'error': error,
        'drawing': _drawing(PRACTICE),
        'new_code': new_code(),
    }
    return render(request, 'study/welcome.html', context, status=400 if error else 200)


def _step(
    request: HttpRequest, participant: Participant, next_: Due, error: str = ''
) -> HttpResponse:
    show(participant, next_)
    context = {
        **_context(participant, next_),
        'drawing': _drawing(next_.encounter.name),
        'error': error,
    }
    return render(request, 'study/step.html', context, status=400 if error else 200)


def _context(participant: Participant, next_: Due) -> dict[str, Any]:
    return {
        'participant': participant,
        'due': next_,
        'scenarios': len(_design().encounters),
        'practised': _design().practice.goal_in_words if next_.place == 1 else '',
    }


def _result(request: HttpRequest, participant: Participant) -> HttpResponse:
    design = _design()
    rows = own_curve.rows(list(records.answers(participant, design)), design.simulated)
    context = {
        'participant': participant,
        'rows': rows,
        'chart': own_curve.chart(rows),
        'strategies': STRATEGIES,
    }
    return render(request, 'study/result.html', context)


def _participant(request: HttpRequest) -> Participant | None:
    code = request.COOKIES.get(_COOKIE, '')
    participant: Participant | None = Participant.objects.filter(code=code).first()
    return participant


def _as_participant(code: str) -> HttpResponse:
    response = HttpResponseRedirect('/study')
    response.set_cookie(_COOKIE, code, max_age=_COOKIE_AGE, httponly=True, samesite='Lax')
    return response
