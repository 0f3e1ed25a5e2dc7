"""HTTP as bytes, for what no client library would send."""

import socket
from contextlib import suppress
from dataclasses import dataclass
from urllib.parse import urlsplit

from tests.patience import LONG


@dataclass(frozen=True)
class Answer:
    """Bytes that came back until the connection was closed."""

    status: int
    head: str
    body: bytes


def connected(address: str, patience: float = LONG) -> socket.socket:
    """An open connection."""
    at = urlsplit(address)
    return socket.create_connection((at.hostname, at.port), timeout=patience)


def head(method: str, path: str, **headers: str) -> bytes:
    """The head of a request; an underscore in a name stands for a hyphen."""
    given = {"Host": "127.0.0.1", "Connection": "close"} | {k.replace("_", "-"): v for k, v in headers.items()}
    lines = (f"{method} {path} HTTP/1.1", *(f"{name}: {value}" for name, value in given.items()), "", "")
    return "\r\n".join(lines).encode("latin-1")


def received(connection: socket.socket) -> bytes:
    """All bytes until the other side closes, whether or not it has read all that was sent."""
    parts = []
    with suppress(ConnectionResetError):
        while part := connection.recv(65536):
            parts.append(part)
    return b"".join(parts)


def answer(connection: socket.socket) -> Answer:
    """The answer on a connection that is closed after it."""
    top, _, body = received(connection).partition(b"\r\n\r\n")
    text = top.decode("latin-1")
    return Answer(int(text.split()[1]), text.lower(), body)


def sent(address: str, request: bytes) -> Answer:
    """The answer to one request."""
    with connected(address) as connection:
        connection.sendall(request)
        return answer(connection)
