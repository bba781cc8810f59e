"""A client that does not keep to HTTP: bytes on a socket, as slow, short or wrong as a test needs them."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from contextlib import contextmanager

from tests.api.serving import Served

ANSWER_S = 60.0


@contextmanager
def connected(served: Served) -> Iterator[socket.socket]:
    """A connection to the service."""
    url = served.client.base_url
    with socket.create_connection((url.host, url.port), timeout=ANSWER_S) as connection:
        yield connection


def head(method: str, target: str, **headers: object) -> bytes:
    """A request up to its body; underscores of names are hyphens."""
    lines = [f"{method} {target} HTTP/1.1", "Host: localhost"]
    lines += [f"{name.replace('_', '-')}: {value}" for name, value in headers.items()]
    return "\r\n".join([*lines, "", ""]).encode("latin-1")


def answer_of(connection: socket.socket) -> tuple[int, bytes]:
    """Status and rest of what comes until the server closes; status 0 when it closes without a word."""
    received = bytearray()
    try:
        while part := connection.recv(65536):
            received += part
    except ConnectionResetError:
        pass  # closed with bytes of ours unread: what was answered before counts
    if not received:
        return 0, b""
    return int(received.split(b" ", 2)[1]), bytes(received)


def first_status(connection: socket.socket) -> int:
    """Status of the first answer; the connection stays open."""
    received = b""
    while b"\r\n" not in received:
        part = connection.recv(65536)
        assert part, "the server closed without an answer"
        received += part
    return int(received.split(b" ", 2)[1])


def exchange(served: Served, request: bytes) -> tuple[int, bytes]:
    """Send bytes and nothing more; what the server says until it closes."""
    with connected(served) as connection:
        try:
            connection.sendall(request)
            connection.shutdown(socket.SHUT_WR)
        except (BrokenPipeError, ConnectionResetError, OSError):
            pass  # refused before all was sent
        return answer_of(connection)
