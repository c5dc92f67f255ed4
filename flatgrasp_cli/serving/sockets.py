"""The same lines over a socket: any number of clients, each answered as long as it stays."""

from __future__ import annotations

import ipaddress
import socket
import socketserver
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

from flatgrasp_cli.errors import UsageError
from flatgrasp_cli.serving.answering import Answerer
from flatgrasp_cli.serving.lines import requests_in

HIGHEST_PORT = 65_535


@dataclass(frozen=True, slots=True)
class Place:
    """Where to listen: an address of `family`, and whether only this machine reaches it."""

    family: socket.AddressFamily
    host: str
    port: int
    loopback: bool


def parse_place(text: str) -> Place:
    """The place of "HOST:PORT"; an IPv6 address stands in brackets, and port 0 is any free one.

    Raises
    ------
    UsageError
        If it is none, or there is no such host.
    """
    host, colon, port = text.rpartition(":")
    host = host.removeprefix("[").removesuffix("]")
    if not (colon and host and port.isascii() and port.isdigit() and int(port) <= HIGHEST_PORT):
        raise UsageError(f"--listen {text}: give it as HOST:PORT, e.g. 127.0.0.1:5555")
    try:
        found = socket.getaddrinfo(host, int(port), type=socket.SOCK_STREAM)
    except (OSError, UnicodeError) as error:
        raise UsageError(f"--listen {text}: there is no host {host!r}; give this machine's, e.g. 127.0.0.1") from error
    family, *_, address = found[0]
    name = str(address[0])
    return Place(family, name, int(port), ipaddress.ip_address(name.partition("%")[0]).is_loopback)


class _Client(socketserver.StreamRequestHandler):
    """One client; that it goes away, in the middle of a line or of its answer, is its own affair."""

    server: _Server
    disable_nagle_algorithm = True

    def handle(self) -> None:
        with suppress(OSError):
            for line in requests_in(self.rfile):
                self.wfile.write(f"{self.server.answerer.answer(line)}\n".encode())

    def finish(self) -> None:
        with suppress(OSError):
            super().finish()


class _Server(socketserver.ThreadingTCPServer):
    allow_reuse_address = True
    daemon_threads = True  # a client that stays connected does not keep the process from ending

    def __init__(self, place: Place, answerer: Answerer) -> None:
        self.address_family = place.family
        self.answerer = answerer
        super().__init__((place.host, place.port), _Client)


def listen(place: Place, answerer: Answerer, say: Callable[[str], None]) -> None:
    """Answer whoever connects, until interrupted; `say` is told where.

    Raises
    ------
    UsageError
        If nobody can listen there.
    """
    try:
        server = _Server(place, answerer)
    except OSError as error:
        raise UsageError(
            f"--listen {place.host}:{place.port}: cannot listen there: {error.strerror or error}; choose another port, "
            "or 0 for any free one"
        ) from error
    with server:
        host, port = server.server_address[:2]
        say(f"listening on {f'[{host!s}]' if ':' in str(host) else host!s}:{port}")
        server.serve_forever()
