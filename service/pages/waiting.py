"""Matters beside flags that wait for a person, by who can act: sessions, certificates, failed work, overdue units."""

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from urllib.parse import quote

from estimator.message import joined, say
from estimator.wording import counted
from service.fleet.records import FleetQuery, UseAt
from service.fleet.store import Fleet
from service.fleet.use import Use
from service.jobs.store import Failures
from service.judging.usable_reading import usable_of
from service.kit.failure import NAMES
from service.kit.measures import day_of
from service.kit.person import Person, Role
from service.outlook.store import Outlooks
from service.papers.records import Meaning
from service.papers.store import Certificates
from service.sessions.records import SessionQuery
from service.sessions.states import RecordState
from service.sessions.store import Sessions
from service.storage.queries import Store

MOST = 100
"""Entries of each kind; the page of the kind has all."""

TO_REVIEW, TO_APPROVE = "Certificate {number} is to be reviewed.", "Certificate {number} is to be approved."


@dataclass(frozen=True)
class WaitingMatter:
    """One thing beside the flags that waits for a person."""

    of: str
    """The unit, the session's unit, or the piece of work."""
    text: str
    """The thing to do or to know, in a sentence."""
    since: datetime | None
    """Since when, UTC; None where that is not known."""
    page: str
    """Address of the page where it is done."""


def waiting_for(store: Store, person: Person, now: datetime) -> tuple[WaitingMatter, ...]:
    """The matters beside flags that this person can do something about, kind by kind."""
    found = [*_overdue(store, now), *_unflagged(store, now)] if person.may(Role.CREW) else []
    if person.may(Role.ENGINEER):
        found += _questioned(store)
        found += _certificates(store)
        found += _failed(store, now)
    return tuple(found)


def _overdue(store: Store, now: datetime) -> Iterator[WaitingMatter]:
    units = Outlooks(store).overdue_units(now)
    if units:
        names = joined(", ", units[:MOST]) + (" …" if len(units) > MOST else "")
        text = say("Calibration overdue: {units}.", units=counted(len(units), "unit"))
        yield WaitingMatter(names, text, None, "/due?when=overdue")


def _unflagged(store: Store, now: datetime) -> Iterator[WaitingMatter]:
    """Units that must not be used and have no flag, such as one whose session decided nothing."""
    wanted = FleetQuery(use=UseAt(Use.NO, now), flagged=False, limit=MOST)
    units = [unit for unit in Fleet(store).units(wanted) if unit.due is None or unit.due >= now]
    for serial, use in usable_of(store, units, now).items():
        yield WaitingMatter(serial, joined(". ", (use.use, use.why)), None, f"/units/{quote(serial)}")


def _questioned(store: Store) -> Iterator[WaitingMatter]:
    for session in Sessions(store).wanted(SessionQuery(state=RecordState.QUESTIONED, limit=MOST)):
        day = day_of(session.started_at)
        text = say("The session of {day} does not count: accept, correct or withdraw it.", day=day)
        yield WaitingMatter(session.unit, text, session.uploaded_at, f"/sessions/{session.id}")


def _certificates(store: Store) -> Iterator[WaitingMatter]:
    for issue, unit, last in Certificates(store).unsigned(MOST):
        said = TO_APPROVE if last is Meaning.REVIEWED else TO_REVIEW
        page = f"/sessions/{issue.session}/certificate"
        yield WaitingMatter(unit, say(said, number=issue.number), issue.issued_at, page)


def _failed(store: Store, now: datetime) -> Iterator[WaitingMatter]:
    for failed in Failures(store).listed(now, MOST):
        text = say("{what} failed: {why}", what=NAMES[failed.kind], why=failed.why)
        yield WaitingMatter(failed.of, text, None, "/jobs#failed")
