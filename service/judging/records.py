"""A unit's accepted sessions for the derivation, their evidence for flags, and the facts behind its permitted use."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import date, datetime
from typing import Any

from pydantic import computed_field

from estimator.message import joined
from service.flags.records import Concern, Matter
from service.fleet.condition import UnitSummary
from service.fleet.use import Use
from service.judging.words import AGAIN, verdict_in_words
from service.kit.answer import Hidden, answer
from service.outlook.records import Action
from service.sessions.decision import Judged, Verdict
from service.sessions.doubt import DoubtKind as Doubt
from service.sessions.doubt import Reservation
from service.sessions.records import UNWEIGHED, Receipt, StoredSession
from service.sessions.states import RecordState
from service.sessions.words.conditions import LOOKING, QUESTIONED, condition_of
from service.stands.records import StandCertificate

Key = tuple[str, str]
"""Matter and place of a flag."""
Moment = tuple[datetime, str]
"""Start of a session and its id: the order of records."""


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
    """Basis of its verdict; empty where it is to be judged, None where it was judged before this was stored. Begins
    with `UNWEIGHED` where its diagnosis is still to be weighed beside the verdict.
    """
    temperature: float | None = None
    """°C"""

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
    """Basis of everything derived of a unit."""

    counted: tuple[Counted, ...]
    """Accepted sessions in order of time."""
    breaks: tuple[datetime, ...]
    """Beginnings of the epochs, the first one apart, in order."""
    choices: tuple[str, ...]
    """Sessions that engineers chose for references, the oldest choice first."""
    references: frozenset[str]
    """Sessions marked as references, whatever their state."""
    diagnosed: Mapping[str, datetime]
    """Sessions with a diagnosis, whatever their state, and when they were measured."""
    waiting: Mapping[str, datetime]
    """Sessions whose diagnosis is asked for, whatever their state, and when they were measured."""
    has_type_laws: bool = False
    """Whether temperature laws of its type are in force."""


@dataclass(frozen=True)
class FlagEvidence:
    """Evidence of one session for its unit's flags, by its verdict or by its diagnosis."""

    concerns: tuple[Concern, ...]
    clear: tuple[tuple[str, str, str], ...]
    """Matter, place (``*`` is any) and why a flag on it could be resolved."""


@dataclass(frozen=True)
class SessionEvidence:
    """Evidence of an accepted session for flags."""

    at: Moment
    unit: str
    """Serial number of the unit."""
    verdict: FlagEvidence | None
    """Evidence of its verdict; None where that was not stored."""
    diagnosis: FlagEvidence | None
    """Evidence of its diagnosis; None where there is none. If the session could not decide, it clears nothing."""
    is_old: bool = False
    """Whether it was judged by a release that did not keep its evidence."""
    block: str = ""
    """Kind of block, where the evidence is of several units."""


@dataclass(frozen=True)
class Decided:
    """Decision on a session under its model revision."""

    session: str
    revision: int
    judged: Judged
    basis: str
    """Basis of the decision."""
    evidence: FlagEvidence | None
    is_first: bool = False
    """Whether nothing was decided of it under this revision before."""


STILL_LOOKING = Reservation(Doubt.PENDING, LOOKING, AGAIN)
"""Reservation of a verdict whose session is not diagnosed yet."""


@dataclass(frozen=True, kw_only=True)
class SaidVerdict:
    """A verdict with its reservations."""

    reservations: tuple[Reservation, ...]
    """Reasons against taking the verdict as it stands; one of kind `pending` while causes are still being looked for.
    Empty where the verdict is plain.
    """
    said: str
    """The verdict in words together with its reservations."""


def said(record: StoredSession | Receipt | UnitSummary) -> dict[str, Any]:
    """The fields of a record with its verdict in words; a questioned session counts for nothing."""
    known = record.reservations
    words = verdict_in_words(condition_of(record.verdict, is_reference=record.is_reference), known)
    if not isinstance(record, UnitSummary) and record.state is RecordState.QUESTIONED:
        words = QUESTIONED.word
    return {**vars(record), "reservations": (STILL_LOOKING,) if known is None else known, "said": words}


@dataclass(frozen=True)
class OpenFlag:
    """An open flag of a unit, in short."""

    id: int
    matter: Matter
    severity: int
    place: str
    summary: str


@dataclass(frozen=True)
class UseFacts:
    """All facts that decide the permitted use of a unit."""

    unit: UnitSummary
    is_calibration: bool = True
    """Whether its latest session calibrates every sensor, so that a reference of it can stand alone."""
    serviced_at: datetime | None = None
    """Time of its last service, up to now, UTC."""
    action: Action | None = None
    """Next action by its outlook; None without an outlook."""
    flags: tuple[OpenFlag, ...] = ()
    """The gravest first."""
    questioned_at: datetime | None = None
    """The latest session after the one that the answer rests on that waits for an engineer."""
    uncertain: tuple[str, ...] = ()
    """Parameters that a reference leaves uncertain by more than their tolerance."""
    expired: StandCertificate | None = None
    """Certificate of the stand, where it had expired on the day of measurement."""
    not_diagnosed: str = ""
    """Reason why the diagnosis of its latest session failed; empty where it did not."""
    is_waiting: bool = False
    """Whether its latest session is to be judged again."""
    correction: str | None = None
    """Id of its latest calibration of every sensor since the last service."""


@answer
@dataclass(frozen=True)
class Usable:
    """Whether a unit may be used now, and why."""

    usable: bool
    """Whether the unit may be used; false in doubt."""
    answer: Use
    """`yes`, `with-reservation`, `no`, or `not-known-yet` while its verdict or dates are being worked out."""
    use: str
    """The answer in words, with the action."""
    why: str
    """Reason in one sentence."""
    action: str
    """Action that is due, as a clause; empty where there is none."""
    reasons: tuple[str, ...]
    """Reasons against the use; empty where it may be used."""
    reservations: tuple[str, ...]
    """Facts to know that do not forbid the use."""
    until: datetime | None
    """The next calibration is due then, UTC."""
    verdict: Verdict | None
    """Verdict of the session behind the answer."""
    session: str | None
    """The latest judged one; null where there is none since the last service."""
    correction: str | None
    """Id of the session whose correction firmware applies; null where no session calibrates every sensor."""
    as_of: datetime
    """Time of the question, UTC."""
    due_reason: Hidden[str] = ""
    """The rule that set the date, or why there is none."""

    @property
    def objection(self) -> str:
        """The gravest reason against the use, or fact to know; empty where there is none."""
        return next(iter((*self.reasons, *self.reservations)), "")

    @property
    def is_overdue(self) -> bool:
        """Whether the date has passed."""
        return self.until is not None and self.until < self.as_of

    @property
    def due(self) -> datetime | None:
        """The due date where it still counts: not where something else must be done first."""
        return self.until if self.usable or self.is_overdue else None

    @computed_field  # type: ignore[prop-decorator]  # the one way to describe a property
    @property
    def reservation(self) -> str:
        """The reservations as one text; empty where there are none."""
        return joined(" ", self.reservations)

    @computed_field  # type: ignore[prop-decorator]  # the one way to describe a property
    @property
    def next_calibration(self) -> date | None:
        """The day of it."""
        return None if self.until is None else self.until.date()
