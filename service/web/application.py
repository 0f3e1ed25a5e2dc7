"""Objects set up at the start and available to every request, as ``app.state.application``."""

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
"""Bytes of an upload that needs no slot: a session of positions has a hundredth."""


class UploadSlots:
    """Slots for large uploads: each holds its bytes in memory. Used by the event loop alone, so it needs no lock."""

    def __init__(self) -> None:
        self._taken = 0

    @contextmanager
    def one_for(self, length: str, limit: int) -> Iterator[None]:
        """A slot for an upload of this announced length, until it has been processed; BusyError where none is free."""
        if length.isdecimal() and int(length) <= SMALL_BODY:
            yield
            return
        if self._taken >= limit:
            raise BusyError("Too many large files are being received; nothing of this one was stored. Send it again.")
        self._taken += 1
        try:
            yield
        finally:
            self._taken -= 1


@dataclass(frozen=True)
class Application:
    """Composed by `create_app`."""

    settings: Settings
    storage: Storage
    clock: Callable[[], datetime]
    bell: Bell
    metrics: Metrics
    parts: Mapping[type, object]
    """Services of the subjects for their routes, by type."""
    places: UploadSlots = field(default_factory=UploadSlots)

    def find(self, kind: type[P]) -> P | None:
        """An optional part."""
        part = self.parts.get(kind)
        assert part is None or isinstance(part, kind)
        return part

    def part(self, kind: type[P]) -> P:
        """A part that is always there."""
        part_found = self.find(kind)
        assert part_found is not None, kind
        return part_found


def application_of(request: Request) -> Application:
    """The application of a request."""
    application: Application = request.app.state.application
    return application
