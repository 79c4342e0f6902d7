"""Requests of the operator's page: the whole page, and the parts of it that have changed.

Each part carries the digest of what it shows; a browser sends back those it has, and
gets the parts that are different now.
"""

from dataclasses import dataclass
from hashlib import sha256

from django import forms
from django.conf import settings
from django.http import HttpRequest, HttpResponse, HttpResponseBadRequest, QueryDict
from django.shortcuts import redirect, render

from mirror_explainer.settings import STRATEGIES
from mirror_explainer.web.operator import shown
from mirror_explainer.web.operator.site import Explainer

_NOT_DISPLAYED = ('controls', 'explained')  # of what a display shows


@dataclass(frozen=True)
class Part:
    """A part of the page, which is replaced as a whole, and what it shows."""

    name: str
    shows: object

    @property
    def template(self) -> str:
        """The template that renders it."""
        return f'operator/{self.name}.html'

    @property
    def digest(self) -> str:
        """The same for the same content."""
        return sha256(repr(self.shows).encode()).hexdigest()[:16]


class Adjustment(forms.Form):
    """What the slider and the choice send."""

    n = forms.IntegerField(min_value=1, max_value=1000)
    strategy = forms.ChoiceField(choices=[(strategy, strategy) for strategy in STRATEGIES])


def page(request: HttpRequest) -> HttpResponse:
    """Return the whole page; with `?follow=on` it asks by itself from the start.

    With `?display=on` it does so, too, and is for a wall: large, without anything to set.
    """
    context = {
        'parts': {part.name: part for part in _parts(request.GET)},
        'follow': _follows(request.GET),
        'display': _is_display(request.GET),
        'explainer': _explainer().heard().explainer,
    }
    return render(request, 'operator/page.html', context)


def news(request: HttpRequest) -> HttpResponse:
    """Return the parts that the browser does not have yet, 204 where there are none."""
    return _changed(request, request.GET)


def ask(request: HttpRequest) -> HttpResponse:
    """Ask the robot, and return what has changed."""
    _explainer().ask()
    return _changed(request, request.POST)


def adjust(request: HttpRequest) -> HttpResponse:
    """Set the explainer's parameters, and ask again, to show what that does to the answer.

    Not with `remember`: the next answer would tell more because it is the next one.
    """
    adjustment = Adjustment(request.POST)
    if not adjustment.is_valid():
        return HttpResponseBadRequest('These are no settings of the explainer.')
    explainer = _explainer()
    heard = explainer.heard()
    remembers = heard.settings is not None and heard.settings.remember
    if explainer.adjust(**adjustment.cleaned_data) and heard.answer and not remembers:
        explainer.ask()
    return _changed(request, request.POST)


def forget(request: HttpRequest) -> HttpResponse:
    """Let the explainer forget what it said."""
    _explainer().forget()
    return _changed(request, request.POST)


def restart(request: HttpRequest) -> HttpResponse:
    """Let the demo robot begin again."""
    _explainer().restart()
    return _changed(request, request.POST)


def _explainer() -> Explainer:
    explainer: Explainer = settings.SITE.explainer
    return explainer


def _follows(query: QueryDict) -> bool:
    return query.get('follow') == 'on' or _is_display(query)


def _is_display(query: QueryDict) -> bool:
    return 'on' in query.getlist('display')


def _parts(query: QueryDict) -> list[Part]:
    shows = shown.parts(_explainer().heard(), _follows(query))
    left_out = _NOT_DISPLAYED if _is_display(query) else ()
    return [Part(name, what) for name, what in shows.items() if name not in left_out]


def _changed(request: HttpRequest, query: QueryDict) -> HttpResponse:
    """Return the parts that differ from those whose digests the browser sent."""
    if 'HX-Request' not in request.headers:  # a browser without scripts
        return redirect('page')
    changed = [part for part in _parts(query) if query.get(part.name) != part.digest]
    if not changed:
        return HttpResponse(status=204)
    return render(request, 'operator/changed.html', {'changed': changed})
