"""Browsers that ask for this machine by a name that it is not known by: they and we are told.

Django refuses them (DNS rebinding), and tells of a setting, with a traceback for each
request. Whoever runs these programs has `--name` instead.
"""

import logging
import threading
import time
from collections.abc import Callable

from django.core.exceptions import DisallowedHost
from django.http import HttpRequest, HttpResponse
from django.http.request import split_domain_port
from django.shortcuts import render
from django.views import defaults

from mirror_explainer.errors import with_cure

# Anybody can ask for any name: of so many the log tells, in so many seconds.
MOST_NAMES = 20
PERIOD = 3600.0
_LONGEST_NAME = 253  # letters (RFC 1035)


def bad_request(request: HttpRequest, exception: Exception) -> HttpResponse:
    """Answer what can't be answered; where the host's name is the cause, with the cure."""
    if isinstance(exception, DisallowedHost):
        return render(request, 'unknown_host.html', {'host': _host(request)}, status=400)
    response: HttpResponse = defaults.bad_request(request, exception)
    return response


class UnknownHosts(logging.Filter):
    """Makes Django's record of an unknown host one line with the cure, once a name and period.

    For the logger `django.security.DisallowedHost`. `clock` gives seconds.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        self._clock = clock
        self._lock = threading.Lock()
        self._told: set[str] = set()
        self._since = clock()

    def filter(self, record: logging.LogRecord) -> bool:
        """Put the record into our words; return whether it is to be logged."""
        host = _host(record.request)  # type: ignore[attr-defined]
        record.msg, record.args = '%s', (_told(host),)
        record.exc_info = record.exc_text = None
        return self._is_news(host)

    def _is_news(self, host: str) -> bool:
        with self._lock:
            if (now := self._clock()) - self._since > PERIOD:
                self._told.clear()
                self._since = now
            if host in self._told or len(self._told) >= MOST_NAMES:
                return False
            self._told.add(host)
            return True


def _host(request: HttpRequest) -> str:
    """Return the name or address that is asked for, '' if no machine can have it."""
    host: str = split_domain_port(request.headers.get('Host', ''))[0]
    return host if len(host) <= _LONGEST_NAME else ''


def _told(host: str) -> str:
    if not host:
        return with_cure(
            'a browser asked for this machine by a name that none can have: there are other '
            'letters in it than a to z, digits, "-" and "."',
            'Open the address that was printed.',
        )
    return with_cure(
        f'a browser asked for {host}, which this machine is not known by',
        f'If it is to be, start this program with --name {host}',
    )
