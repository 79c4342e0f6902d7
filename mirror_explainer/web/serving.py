"""Serving a site with waitress, until the process is told to end."""

import errno
import signal
import socket
from collections.abc import Mapping
from types import MappingProxyType
from typing import NoReturn

from mirror_explainer.errors import InputError
from mirror_explainer.web.address import Address

_THREADS = 8
_LARGEST_REQUEST = 64 * 1024  # bytes, more than any form has
# Browsers keep connections open that they may never use again: there is room for those of
# hundreds of people, and who is silent for so many seconds makes room for newcomers.
_CONNECTIONS = 900  # below what a process may open, by default 1024 files
_IDLE = 20
_CLEANUP = 2
# What may be in the way, and what to do about it.
_OBSTACLES: Mapping[int, tuple[str, str]] = {
    errno.EADDRINUSE: (
        'another program serves at this address',
        'End it, or name another with --port; --port 0 takes any that is free.',
    ),
    errno.EACCES: (
        'only administrators may serve at this port',
        'Name one from 1024 on with --port.',
    ),
    errno.EADDRNOTAVAIL: (
        'this machine does not have this address',
        'Name one of its own with --host; 0.0.0.0 is all of them.',
    ),
}


def serve(address: Address, more: Mapping[str, str] = MappingProxyType({})) -> None:
    """Serve the configured site, say on stdout where, and return on SIGINT or SIGTERM.

    `more` are further addresses to tell: what they are for, and what follows the site's own.
    To be called from the main thread. Raises InputError, with the cure, or OSError where
    nothing can listen at the address.
    """
    # Not before the extras are known to be there.
    from django.core.wsgi import get_wsgi_application
    from waitress import create_server

    with listening(address) as bound:
        server = create_server(
            get_wsgi_application(),
            sockets=[bound],
            threads=_THREADS,
            connection_limit=_CONNECTIONS,
            channel_timeout=_IDLE,
            cleanup_interval=_CLEANUP,
            asyncore_use_poll=True,  # select() ends at 1024 files
            max_request_body_size=_LARGEST_REQUEST,
            ident=None,
        )
        try:
            for told in (signal.SIGINT, signal.SIGTERM):
                signal.signal(told, _end)
            port = bound.getsockname()[1]
            for what, page in more.items():
                print(f'{what}: {address.url(port, page)}', flush=True)
            print(f'Open {address.url(port)}', flush=True)
            server.run()
        except KeyboardInterrupt:
            pass
        finally:
            # A second signal must not cut short what the first one began.
            for told in (signal.SIGINT, signal.SIGTERM):
                signal.signal(told, signal.SIG_IGN)
            server.close()


def listening(address: Address) -> socket.socket:
    """Return a socket that listens at the address.

    Raises InputError, with the cure, or OSError where nothing can.
    """
    [(family, _, _, _, where), *_] = socket.getaddrinfo(
        address.host, address.port, type=socket.SOCK_STREAM
    )
    try:
        return socket.create_server(where[:2], family=family, backlog=_CONNECTIONS)
    except OSError as error:
        obstacle = _OBSTACLES.get(error.errno or 0)
        if obstacle is None:
            raise
        reason, cure = obstacle
        raise InputError(f'{address.host}:{address.port}', reason, cure=cure) from error


def _end(*_: object) -> NoReturn:
    raise KeyboardInterrupt
