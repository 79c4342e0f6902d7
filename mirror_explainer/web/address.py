"""Where a site is served, and who may come: loopback without, all else with a token.

`Host` headers are checked against the names that the machine is known to have, so that a
page elsewhere cannot reach this one by a name that it lets point here (DNS rebinding).
"""

import argparse
import contextlib
import ipaddress
import re
import secrets
import socket
from dataclasses import dataclass

_LOOPBACK = ('127.0.0.1', 'localhost', '[::1]')
_TOKEN = re.compile(r'[A-Za-z0-9_-]{8,}')


@dataclass(frozen=True)
class Address:
    """Where a site is served.

    `names` are the hosts that a browser may ask for; `token` has to be known by
    whoever comes, None on loopback, where only this machine's users come.
    """

    host: str
    port: int
    names: tuple[str, ...]
    token: str | None

    def url(self, port: int, page: str = '') -> str:
        """Return the address to open in a browser; `port` is the one listened at."""
        token = f'{"&" if "?" in page else "?"}token={self.token}' if self.token else ''
        return f'http://{self.names[0]}:{port}/{page}{token}'


def add_address_arguments(parser: argparse.ArgumentParser, port: int) -> None:
    """Let a command take --host, --port, --name and --token."""
    group = parser.add_argument_group('server')
    group.add_argument(
        '--host', default='127.0.0.1', metavar='ADDRESS',
        help="this machine's address to listen at; 0.0.0.0 is all of them (default 127.0.0.1: "
        'reached from this machine only)',
    )  # fmt: skip
    group.add_argument(
        '--port', type=_port, default=port, metavar='N', help=f'0 is any free one (default {port})'
    )
    group.add_argument(
        '--name', action='append', default=[], metavar='HOST',
        help='another name or address that browsers use for this machine (may be repeated)',
    )  # fmt: skip
    group.add_argument(
        '--token', type=_token, metavar='SECRET',
        help='what a browser has to know, in the address that is printed; beyond 127.0.0.1 one '
        'is made where none is given',
    )  # fmt: skip


def address(options: argparse.Namespace) -> Address:
    """Return the address that the command's arguments ask for. Raises OSError for no host."""
    loopback = _is_loopback(options.host)
    names = [*options.name, *(_LOOPBACK if loopback else _names(options.host))]
    return Address(
        host='127.0.0.1' if options.host == 'localhost' else options.host,
        port=options.port,
        names=tuple(dict.fromkeys(names)),
        token=options.token or (None if loopback else secrets.token_urlsafe(16)),
    )


def _is_loopback(host: str) -> bool:
    return all(ipaddress.ip_address(found).is_loopback for found in _addresses(host))


def _names(host: str) -> list[str]:
    """Return what browsers may call this machine when it listens at this address."""
    if not any(ipaddress.ip_address(found).is_unspecified for found in _addresses(host)):
        return [_in_url(host)]
    own = socket.gethostname().lower()
    numbers: list[str] = []
    with contextlib.suppress(socket.gaierror):  # not every machine can look itself up
        numbers = _addresses(own)
    return [_outgoing(), *map(_in_url, numbers), own, f'{own}.local', *_LOOPBACK]


def _addresses(host: str) -> list[str]:
    """Return the IP addresses of a name or address, each once."""
    found = socket.getaddrinfo(host, None, type=socket.SOCK_STREAM)
    return list(dict.fromkeys(str(entry[4][0]) for entry in found))


def _outgoing() -> str:
    """Return this machine's address in its network, without sending anything."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(('192.0.2.1', 9))  # an address that no machine has (RFC 5737)
        except OSError:
            return '127.0.0.1'  # no network
        return str(probe.getsockname()[0])


def _in_url(host: str) -> str:
    return f'[{host}]' if ':' in host else host.lower()


def _port(text: str) -> int:
    if not text.isdecimal() or int(text) > 65535:
        raise argparse.ArgumentTypeError(f'"{text}" is no port from 0 to 65535')
    return int(text)


def _token(text: str) -> str:
    if not _TOKEN.fullmatch(text):
        raise argparse.ArgumentTypeError('a token has 8 or more letters, digits, "-" and "_"')
    return text
