"""The client of the service, one method a call."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any, Literal, TypeVar
from urllib.parse import quote

import httpx

from service.client.answers import Diagnosis, Flag, Point, Receipt, Session, Unit, Usable, read
from service.client.connection import Connection
from service.errors import ServiceError

T = TypeVar("T")
TOKEN = "IMU_HEALTH_TOKEN"  # noqa: S105 - the name of a variable
"""Environment variable with the caller's token; on a command line other users could read it."""
DEFAULT_SERVER = "http://127.0.0.1:8000"
"""Default address of the service."""
TIMEOUT = httpx.Timeout(300.0, connect=5.0)
"""Seconds; the report of a large fleet takes some tens."""


@contextmanager
def connect(server: str = DEFAULT_SERVER, token: str | None = None, language: str = "en") -> "Iterator[Client]":
    """A client of the service at an address, with a token or the environment's, and a language for messages;
    ServiceError for an invalid address."""
    try:
        http = httpx.Client(base_url=f"{server.rstrip('/')}/api/v1", timeout=TIMEOUT)
    except httpx.InvalidURL as fault:
        raise ServiceError(f"{server} is not an address: {fault}") from fault
    secret = os.environ.get(TOKEN, "") if token is None else token
    if secret:
        http.headers["Authorization"] = f"Bearer {secret}"
    http.headers["Accept-Language"] = language
    with http:
        yield Client(server, http)


@dataclass(frozen=True)
class Client(Connection):
    """A running service; a call that it refuses or does not answer raises an error of `service.errors`."""

    def upload(self, file: Path | bytes, *, name: str = "session", **stated: str) -> Receipt:
        """Stores a session file, once however often it is sent; ``stated``: form fields of the file: supersedes, by,
        why, mapping. Its verdict may still lack reservations: `verdict_of` waits for them."""
        content = file if isinstance(file, bytes) else file.read_bytes()
        return read(Receipt, self.send(name if isinstance(file, bytes) else file.name, content, stated))

    def verdict_of(self, session: str) -> Session:
        """A session after its diagnosis, with all reservations of its verdict; after about two minutes with one of kind
        ``pending``."""
        self.is_diagnosed(session)
        return self.session(session)

    def session(self, id: str) -> Session:
        """A stored session."""
        return read(Session, self.get(f"/sessions/{_in_path(id)}").json())

    def unit(self, serial: str) -> Unit:
        """A unit in short; its ``document`` has everything but the history."""
        answer = self.get(f"/units/{_in_path(serial)}").json()
        return read(Unit, answer["summary"])

    def units(self, **wanted: Any) -> Iterator[Unit]:
        """Units, worst first, page after page; ``wanted`` as in the API: verdict, q, unit_type, stand, order …"""
        return self._pages(Unit, "/units", "units", {"limit": 1000, **wanted})

    def usable(self, serial: str) -> Usable:
        """Whether a unit may be used now."""
        return read(Usable, self.get(f"/units/{_in_path(serial)}/usable").json())

    def history(
        self,
        serial: str,
        *,
        parameter: str | None = None,
        sensor: str | None = None,
        since: datetime | None = None,
        until: datetime | None = None,
    ) -> Iterator[Point]:
        """The parameters of a unit through time, oldest first, page after page."""
        query = {"parameter": parameter, "sensor": sensor, "since": _written(since), "until": _written(until)}
        return self._pages(Point, f"/units/{_in_path(serial)}/history", "points", {"limit": 10_000, **query})

    def diagnosis(self, session: str) -> Diagnosis:
        """Errors of the simulation for a session; waits for the diagnosis."""
        if not self.is_diagnosed(session):
            raise ServiceError(f"The diagnosis of {session} is still being made; ask again.")
        return read(Diagnosis, self.get(f"/sessions/{_in_path(session)}/diagnosis").json())

    def flags(self, *, unit: str | None = None, state: str | None = None) -> Iterator[Flag]:
        """Flags, open ones first."""
        return self._pages(Flag, "/flags", "flags", {"limit": 1000, "unit": unit, "state": state})

    def acknowledge(self, flag: int, *, by: str, why: str) -> Flag:
        """Acknowledges a flag: somebody looks after it, and it can stay for now."""
        return read(Flag, self.post(f"/flags/{flag}/acknowledge", {"by": by, "why": why}))

    def resolve(self, flag: int, *, by: str, why: str) -> Flag:
        """Resolves a flag: the matter is settled."""
        return read(Flag, self.post(f"/flags/{flag}/resolve", {"by": by, "why": why}))

    def certificate(self, session: str, form: Literal["pdf", "dcc"] = "pdf", *, by: str = "") -> bytes:
        """The certificate of a session: PDF to sign, or XML for programs; ``by`` is stored with its number."""
        return self.get(f"/sessions/{_in_path(session)}/certificate", format=form, by=by).content

    def every(self, path: str, name: str, **query: Any) -> Iterator[dict[str, Any]]:
        """The entries of a list as the API answers them, page after page."""
        page: int | None = 1
        while page is not None:
            answer = self.get(path, page=page, **query).json()
            yield from answer[name]
            page = answer["next_page"]

    def _pages(self, kind: type[T], path: str, name: str, query: dict[str, Any]) -> Iterator[T]:
        return (read(kind, entry) for entry in self.every(path, name, **query))


def _in_path(name: str) -> str:
    return quote(name, safe="")


def _written(moment: datetime | None) -> str | None:
    return None if moment is None else moment.isoformat()
