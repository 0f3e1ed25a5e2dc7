"""A unit's accepted sessions as the derivation sees them, and what they tell of flags."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime

from service.flags.records import Concern
from service.sessions.decision import Judged
from service.sessions.records import UNWEIGHED


@dataclass(frozen=True)
class Counted:
    """An accepted session, in short."""

    id: str
    block: str
    programme: str
    at: datetime
    revision: int
    is_reference: bool
    basis: str | None
    """What its verdict rests on; empty where it is to be judged, None where it was judged before this was kept. Heads
    by `UNWEIGHED` where its diagnosis is still to be weighed beside the verdict."""

    @property
    def is_unweighed(self) -> bool:
        """Whether its reservations may be those of the verdict before."""
        return self.basis is not None and self.basis.startswith(UNWEIGHED)

    @property
    def rests_on(self) -> str | None:
        """The basis alone."""
        return self.basis if self.basis is None else self.basis.removeprefix(UNWEIGHED)


@dataclass(frozen=True)
class UnitRecords:
    """What everything that is derived of a unit rests on."""

    counted: tuple[Counted, ...]
    """In order of time."""
    breaks: tuple[datetime, ...]
    """When the epochs begin, the first one apart, in order."""
    choices: tuple[str, ...]
    """Sessions that engineers chose for references, the oldest choice first."""
    references: frozenset[str]
    """Sessions that are said to be what others are judged against, whatever their state."""
    diagnosed: Mapping[str, datetime]
    """Sessions with a diagnosis, whatever their state, and when they were measured."""
    waiting: Mapping[str, datetime]
    """The same of sessions whose diagnosis is asked for."""


@dataclass(frozen=True)
class Told:
    """What one session tells of its unit's flags: by its verdict, or by its diagnosis."""

    concerns: tuple[Concern, ...]
    clear: tuple[tuple[str, str, str], ...]
    """Matter, place (``*`` is any) and why a flag on it could be resolved."""


@dataclass(frozen=True)
class Decided:
    """What was decided of a session under its model revision."""

    session: str
    revision: int
    judged: Judged
    basis: str
    """What it rests on."""
    told: Told | None
    is_first: bool = False
    """Whether nothing was decided of it under this revision before."""
