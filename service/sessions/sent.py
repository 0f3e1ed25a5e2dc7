"""A session's file as it is sent, and its sender's statements."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from datetime import datetime
from typing import Any

from service.kit.arriving_files import Content
from service.sessions.records import Marks


@dataclass(frozen=True)
class Replaced:
    """The session that a corrected file supersedes, with the person and the reason."""

    session: str
    who: str
    why: str


@dataclass(frozen=True, kw_only=True)
class Stated(Marks):
    """Statements of a sender on a file, besides its contents; carried whole from the request to the stored session."""

    replaces: Replaced | None = None
    mapping: Mapping[str, Any] | None = None
    """Mapping by which a table of a user-defined layout is read."""

    def stated(self) -> dict[str, Any]:
        """The statements by name, for another form of the same file."""
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
    """SHA-256 of the content."""
    filename: str
    """Last part of the sender's name for the file, printable; only ever shown, never used as a path."""
    at: datetime
    who: str
    """Person who sent it."""


@dataclass(frozen=True)
class Sent(Stated):
    """A file that was received whole and is still to be read."""

    place: str
    """Name of the file among those that wait."""
    sha256: str
    size: int
    """Bytes."""
    account: str = ""
    """Sender's name in the audit trail."""
