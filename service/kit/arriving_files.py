"""A file as it comes in, before anything is known of what it holds."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from datetime import datetime
from pathlib import Path
from typing import Any

DEMONSTRATION = "demonstration"
"""Signs every upload of the demonstration fleet."""


@dataclass(frozen=True)
class Replaced:
    """The session that a corrected file stands for, who says so and why."""

    session: str
    who: str
    why: str


@dataclass(frozen=True)
class Landed:
    """The bytes of a long upload, in a file of its own."""

    path: Path
    sha256: str
    size: int

    def __len__(self) -> int:
        return self.size


Content = bytes | Landed
"""Of an upload: bytes where they are few."""


def where(content: Content) -> bytes | Path:
    """What reads it is given: the bytes, or where they lie."""
    return content.path if isinstance(content, Landed) else content


def held(content: Content) -> bytes:
    """All of its bytes, in memory."""
    return content.path.read_bytes() if isinstance(content, Landed) else content


@dataclass(frozen=True, kw_only=True)
class Stated:
    """What a sender states of a file, beside what it holds; carried whole from the request to the stored session."""

    is_check: bool = False
    """Whether it is only a check, which moves no due date."""
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
