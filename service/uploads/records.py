"""What came in: a file that was stored as a session, or one that was refused."""

from dataclasses import dataclass
from datetime import datetime

from estimator.errors import Problem
from service.jobs.records import UNDER_WAY
from service.sessions.records import StoredSession

REFUSED = "r"
"""Begins the name of a refusal, where a session's is its id."""


def job_number(name: str) -> int | None:
    """The number of the job that a name names; None of any other name."""
    return _number(name, UNDER_WAY)


def refusal_number(name: str) -> int | None:
    """The number of the refusal that a name names; None of any other name."""
    return _number(name, REFUSED)


def _number(name: str, begins: str) -> int | None:
    number = name.removeprefix(begins)
    is_one = name.startswith(begins) and number.isascii() and number.isdigit() and len(number) < 10
    return int(number) if is_one else None


@dataclass(frozen=True)
class Refusal:
    """A file that could not be used; its bytes are not kept."""

    number: int
    at: datetime
    filename: str
    sha256: str
    size: int
    """Bytes."""
    problems: tuple[Problem, ...]


@dataclass(frozen=True)
class Arrival:
    """One upload and what became of it: either a session or a refusal."""

    at: datetime
    session: StoredSession | None
    refusal: Refusal | None

    @property
    def name(self) -> str:
        """As an address names it: the session's id, or ``r`` and the number of the refusal."""
        if self.refusal is not None:
            return f"{REFUSED}{self.refusal.number}"
        return "" if self.session is None else self.session.id

    @property
    def key(self) -> tuple[datetime, bool, str]:
        """Its place among all: of one time refusals come after sessions."""
        if self.refusal is not None:
            return self.at, True, f"{self.refusal.number:012d}"
        assert self.session is not None, "an arrival is one of the two"
        return self.at, False, self.session.id


@dataclass(frozen=True)
class ArrivalQuery:
    """Which arrivals are wanted, newest first."""

    text: str | None = None
    """Part of the file's name, small and capital letters alike."""
    refused: bool = False
    """Only those that were refused."""
    after_session: str | None = None
    after_refusal: int | None = None
    """What the list goes on after; one that is not there begins it anew."""
    limit: int = 100
