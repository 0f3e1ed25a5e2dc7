"""A file as it comes in, before anything is known of what it holds."""

from collections.abc import Mapping
from dataclasses import dataclass
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


@dataclass(frozen=True)
class SentFile:
    """A file as its sender named it."""

    filename: str
    content: Content
    replaces: Replaced | None = None
    mapping: Mapping[str, Any] | None = None
    """How a table of one's own layout is read, as it was sent."""
    is_check: bool = False
    """Whether it only looks after the unit and moves no date."""


@dataclass(frozen=True)
class Received:
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
    is_check: bool = False
    """Whether it only looks after the unit and moves no date."""


@dataclass(frozen=True)
class Sent:
    """A file that was received whole and is still to be read, with what its sender said of it."""

    place: str
    """Its name among those that wait."""
    sha256: str
    size: int
    """Bytes."""
    account: str = ""
    """As the audit trail names who sent it."""
    is_check: bool = False
    replaces: Replaced | None = None
    mapping: Mapping[str, Any] | None = None
    """How a table of one's own layout is read."""
