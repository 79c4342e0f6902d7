"""Serving a site with waitress, until the process is told to end."""

import signal
import socket
from typing import NoReturn

from mirror_explainer.web.address import Address

_THREADS = 8
_LARGEST_REQUEST = 64 * 1024  # bytes, more than any form has


def serve(address: Address) -> None:
    """Serve the configured site, say on stdout where, and return on SIGINT or SIGTERM.

    To be called from the main thread. Raises OSError where nothing can listen at
    the address.
    """
    # Not before the extras are known to be there.
    from django.core.wsgi import get_wsgi_application
    from waitress import create_server

    with _listening(address) as listening:
        server = create_server(
            get_wsgi_application(),
            sockets=[listening],
            threads=_THREADS,
            max_request_body_size=_LARGEST_REQUEST,
            ident=None,
        )
        try:
            for told in (signal.SIGINT, signal.SIGTERM):
                signal.signal(told, _end)
            print(f'Open {address.url(listening.getsockname()[1])}', flush=True)
            server.run()
        except KeyboardInterrupt:
            pass
        finally:
            # A second signal must not cut short what the first one began.
            for told in (signal.SIGINT, signal.SIGTERM):
                signal.signal(told, signal.SIG_IGN)
            server.close()


def _listening(address: Address) -> socket.socket:
    [(family, _, _, _, where), *_] = socket.getaddrinfo(
        address.host, address.port, type=socket.SOCK_STREAM
    )
    return socket.create_server(where[:2], family=family)


def _end(*_: object) -> NoReturn:
    raise KeyboardInterrupt
