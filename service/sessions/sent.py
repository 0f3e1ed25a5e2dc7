"""A session's file as it is sent, and what its sender states beside it."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from datetime import datetime
from typing import Any

from service.kit.arriving_files import Content
from service.sessions.records import Marks


@dataclass(frozen=True)
class Replaced:
    """The session that a corrected file supersedes, who says so and why."""

    session: str
    who: str
    why: str


@dataclass(frozen=True, kw_only=True)
class Stated(Marks):
    """What a sender states of a file, beside what it holds; carried whole from the request to the stored session."""

    replaces: Replaced | None = None
    mapping: Mapping[str, Any] | None = None
    """How a table of a user-defined layout is read."""

    def stated(self) -> dict[str, Any]:
        """Its fields by name, for another form of the same file."""
        return {field.name: getattr(self, field.name) for field in fields(Stated)}


NOTHING_STATED = Stated()


@dataclass(frozen=True)
class SentFile(Stated):
    """A file as its sender named it."""

    filename: str
    content: Content


@dataclass(frozen=True)
class Received(Stated):
    """An upload on its way through the steps."""

    size: int
    """Bytes."""
    sha256: str
    """Of the content."""
    filename: str
    """The last part of the sender's name, printable; only ever shown, never used as a path."""
    at: datetime
    who: str
    """That sent it."""


@dataclass(frozen=True)
class Sent(Stated):
    """A file that was received whole and is still to be read."""

    place: str
    """Its name among those that wait."""
    sha256: str
    size: int
    """Bytes."""
    account: str = ""
    """As the audit trail names who sent it."""
