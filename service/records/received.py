"""A file as it comes in, before anything is known of what it holds."""

from dataclasses import dataclass
from datetime import datetime


@dataclass(frozen=True)
class Replaced:
    """The session that a corrected file stands for, who says so and why."""

    session: str
    who: str
    why: str


@dataclass(frozen=True)
class SentFile:
    """A file as its sender named it."""

    filename: str
    content: bytes
    replaces: Replaced | None = None


@dataclass(frozen=True)
class Received:
    """An upload on its way through the steps."""

    content: bytes
    sha256: str
    """Of the content."""
    filename: str
    """The last part of the sender's name, printable; only ever shown, never used as a path."""
    at: datetime
    who: str
    """That sent it."""
    simulated: bool
    """Whether it is of the demonstration."""
