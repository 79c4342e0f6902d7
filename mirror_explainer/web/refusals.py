"""What is refused: whoever asked is told in words, and the log in few lines.

Anybody can ask for anything: no kind of request may fill a disk. Where Django tells of its
settings, whoever runs these programs is told of their options.
"""

import logging
import time
from collections.abc import Callable

from django.core.exceptions import DisallowedHost
from django.http import HttpRequest, HttpResponse
from django.http.request import split_domain_port
from django.shortcuts import render
from django.views import defaults

from mirror_explainer.errors import one_line, with_cure

# So many different warnings in so many seconds are logged, each once.
MOST_WARNINGS = 20
PERIOD = 3600.0
_LONGEST_NAME = 253  # letters (RFC 1035)

_log = logging.getLogger(__name__)


class FewWarnings(logging.Filter):
    """Lets errors through, and of warnings each once a period, and few in all.

    For the handler that writes the log. `clock` gives seconds.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        self._clock = clock
        self._told: set[str] = set()
        self._since = clock()

    def filter(self, record: logging.LogRecord) -> bool:
        """Return whether the record is to be logged; its handler's lock is held."""
        if record.levelno >= logging.ERROR:
            return True
        if (now := self._clock()) - self._since > PERIOD:
            self._told.clear()
            self._since = now
        message = record.getMessage()
        if message in self._told or len(self._told) >= MOST_WARNINGS:
            return False
        self._told.add(message)
        record.msg, record.args = '%s', (one_line(message),)
        return True


def log_few_lines() -> None:
    """Let this process log warnings and errors on stderr, as `FewWarnings` has it."""
    handler = logging.StreamHandler()
    handler.addFilter(FewWarnings())
    logging.basicConfig(format='%(message)s', level=logging.WARNING, handlers=[handler])
    # An error with a traceback for each request: `bad_request` has a line with the cure.
    logging.getLogger('django.security.DisallowedHost').disabled = True


def bad_request(request: HttpRequest, exception: Exception) -> HttpResponse:
    """Answer what can't be answered; where the host's name is the cause, with the cure."""
    if not isinstance(exception, DisallowedHost):
        response: HttpResponse = defaults.bad_request(request, exception)
        return response
    host: str = split_domain_port(request.headers.get('Host', ''))[0]
    if not host or len(host) > _LONGEST_NAME:
        host = ''
        reason = 'a browser asked for this machine by a name that none can have'
        cure = 'Open the address that was printed.'
    else:
        reason = f'a browser asked for {host}, which this machine is not known by'
        cure = f'If it is to be, start this program with --name {host}'
    _log.warning('%s', with_cure(reason, cure))
    return render(request, 'unknown_host.html', {'host': host}, status=400)
