"""What is joined at the start and every request can reach, as ``app.state.application``."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import datetime
from typing import TypeVar

from fastapi import Request

from service.errors import BusyError
from service.kit.bell import Bell
from service.kit.metrics import Metrics
from service.settings import Settings
from service.storage import Storage

P = TypeVar("P")
"""A part of the application."""
SMALL_BODY = 1024 * 1024
"""Bytes of an upload that needs no place: a session of positions has a hundredth."""


class Places:
    """Of large uploads: each holds its bytes in memory. Used by the event loop alone, so it needs no lock."""

    def __init__(self) -> None:
        self._taken = 0

    @contextmanager
    def one_for(self, length: str, most: int) -> Iterator[None]:
        """A place for an upload of this announced length, until it is worked on; BusyError where all are taken."""
        if length.isdecimal() and int(length) <= SMALL_BODY:
            yield
            return
        if self._taken >= most:
            raise BusyError("Too many large files are being received; nothing of this one was stored. Send it again.")
        self._taken += 1
        try:
            yield
        finally:
            self._taken -= 1


@dataclass(frozen=True)
class Application:
    """What `create_app` joins."""

    settings: Settings
    storage: Storage
    clock: Callable[[], datetime]
    bell: Bell
    metrics: Metrics
    parts: Mapping[type, object]
    """What subjects give to their routes, each under its type."""
    places: Places = field(default_factory=Places)

    def find(self, kind: type[P]) -> P | None:
        """A part that the operator may have left out."""
        found = self.parts.get(kind)
        assert found is None or isinstance(found, kind)
        return found

    def part(self, kind: type[P]) -> P:
        """A part that is always there."""
        found = self.find(kind)
        assert found is not None, kind
        return found


def application_of(request: Request) -> Application:
    """The application that a request came to."""
    application: Application = request.app.state.application
    return application
