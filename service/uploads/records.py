"""Uploads: a file stored as a session, or refused."""

from dataclasses import dataclass
from datetime import datetime

from estimator.errors import Problem
from service.jobs.records import UNDER_WAY
from service.sessions.records import StoredSession

REFUSED = "r"
"""Prefix of the name of a refusal; that of a session is its id."""


def job_number(name: str) -> int | None:
    """The number of the job in a name; None for any other name."""
    return _number(name, UNDER_WAY)


def refusal_number(name: str) -> int | None:
    """The number of the refusal in a name; None for any other name."""
    return _number(name, REFUSED)


def _number(name: str, prefix: str) -> int | None:
    number = name.removeprefix(prefix)
    is_valid = name.startswith(prefix) and number.isascii() and number.isdigit() and len(number) < 10
    return int(number) if is_valid else None


@dataclass(frozen=True)
class Refusal:
    """A file that could not be used; its bytes are not stored."""

    number: int
    at: datetime
    filename: str
    sha256: str
    size: int
    """Bytes."""
    problems: tuple[Problem, ...]


@dataclass(frozen=True)
class Arrival:
    """One upload and its outcome: either a session or a refusal."""

    at: datetime
    session: StoredSession | None
    refusal: Refusal | None

    @property
    def name(self) -> str:
        """Name in addresses: the session's id, or ``r`` and the number of the refusal."""
        if self.refusal is not None:
            return f"{REFUSED}{self.refusal.number}"
        return "" if self.session is None else self.session.id

    @property
    def key(self) -> tuple[datetime, bool, str]:
        """Sort key: at the same time refusals come after sessions."""
        if self.refusal is not None:
            return self.at, True, f"{self.refusal.number:012d}"
        assert self.session is not None, "an arrival is one of the two"
        return self.at, False, self.session.id


@dataclass(frozen=True)
class ArrivalQuery:
    """Filter of arrivals, newest first."""

    text: str | None = None
    """Part of the file's name, case-insensitive."""
    refused: bool = False
    """Whether only refused uploads are wanted."""
    after_session: str | None = None
    after_refusal: int | None = None
    """Start of the list after this one; from the beginning where it does not exist."""
    limit: int = 100
