"""Work that waits for a person, by role: sessions, certificates, flags, failed work, overdue units."""

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from estimator.message import joined, say
from estimator.wording import counted
from service.flags.pages import flag_cards
from service.flags.records import NOBODY, Assignee
from service.flags.store import FlagQuery, Flags
from service.jobs.store import Failures
from service.kit.answer import answer
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

MOST = 15
"""Most entries of each kind; its own page has all."""


TO_REVIEW, TO_APPROVE = "Certificate {number} is to be reviewed.", "Certificate {number} is to be approved."


class WaitingKind(StrEnum):
    """Kinds of waiting work."""

    MINE = "assigned-to-me"
    OVERDUE = "overdue"
    SESSION = "questioned-session"
    CERTIFICATE = "certificate"
    FLAG = "unassigned-flag"
    WORK = "failed-work"


@answer
@dataclass(frozen=True)
class ToDo:
    """One piece of work that waits for a person."""

    kind: WaitingKind
    """`assigned-to-me`, `overdue`, `questioned-session`, `certificate`, `unassigned-flag` or `failed-work`."""
    of: str
    """The unit, the session's unit, or the piece of work."""
    text: str
    """Action or fact to know, in a sentence."""
    since: datetime | None
    """Time since which it waits, UTC; null where that is not known."""
    page: str
    """Address of the page where it is done."""


def waiting_for(store: Store, person: Person, now: datetime) -> tuple[ToDo, ...]:
    """The work that this person can do, kind by kind."""
    found = list(_flags(store, WaitingKind.MINE, Assignee(person.name, person.login))) if person.login else []
    if person.may(Role.CREW):
        found += _overdue(store, now)
    if person.may(Role.ENGINEER):
        found += _questioned(store)
        found += _certificates(store)
        found += _flags(store, WaitingKind.FLAG, NOBODY)
        found += _failed(store, now)
    return tuple(found)


def _flags(store: Store, kind: WaitingKind, assignee: Assignee) -> Iterator[ToDo]:
    found = Flags(store).page(FlagQuery(unresolved=True, assignee=assignee, limit=MOST))
    for flag, card in zip(found, flag_cards(found), strict=True):
        yield ToDo(kind, flag.subject or flag.unit, flag.summary, flag.raised_at, f"{card.home}#flags")


def _overdue(store: Store, now: datetime) -> Iterator[ToDo]:
    units = Outlooks(store).overdue_units(now)
    if units:
        names = joined(", ", units[:MOST]) + (" …" if len(units) > MOST else "")
        text = say("Calibration overdue: {units}.", units=counted(len(units), "unit"))
        yield ToDo(WaitingKind.OVERDUE, names, text, None, "/due?when=overdue")


def _questioned(store: Store) -> Iterator[ToDo]:
    for session in Sessions(store).wanted(SessionQuery(state=RecordState.QUESTIONED, limit=MOST)):
        day = day_of(session.started_at)
        text = say("The session of {day} does not count: accept, correct or withdraw it.", day=day)
        yield ToDo(WaitingKind.SESSION, session.unit, text, session.uploaded_at, f"/sessions/{session.id}")


def _certificates(store: Store) -> Iterator[ToDo]:
    for issue, unit, last in Certificates(store).unsigned(MOST):
        said = TO_APPROVE if last is Meaning.REVIEWED else TO_REVIEW
        page = f"/sessions/{issue.session}/certificate"
        yield ToDo(WaitingKind.CERTIFICATE, unit, say(said, number=issue.number), issue.issued_at, page)


def _failed(store: Store, now: datetime) -> Iterator[ToDo]:
    for failed in Failures(store).listed(now, MOST):
        text = say("{what} failed: {why}", what=NAMES[failed.kind], why=failed.why)
        yield ToDo(WaitingKind.WORK, failed.of, text, None, "/jobs#failed")
