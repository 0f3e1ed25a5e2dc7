"""One page of a unit's present result, to hand over with it: may it be used, until when, with what reservations, and
which parameters are closest to their tolerances."""

from dataclasses import dataclass
from datetime import datetime

from service.fleet.condition import UnitSummary
from service.fleet.store import Fleet
from service.fleet.use import Use
from service.judging.records import Usable
from service.judging.usable_reading import usable_of
from service.judging.usable_words import next_in_words
from service.kit.measures import THIN, day_of, number
from service.languages.language import Language
from service.papers.certificate.facts import Fact
from service.papers.found_and_left import JudgedChange, moved
from service.papers.typeset import typeset
from service.sessions.decision import Decision
from service.sessions.records import StoredSession
from service.sessions.store import Sessions
from service.sessions.words.conditions import Condition, condition_of
from service.settings import VERSION
from service.storage.queries import Store

TEMPLATE = "status.typ"
MOST_PARAMETERS = 10
MOST_RESERVATIONS = 5
TONES = {Use.YES: "pass", Use.RESERVED: "conditional-pass", Use.NO: "fail", Use.PENDING: "undecidable"}
"""Colours of the permitted use."""


@dataclass(frozen=True)
class StatusRow:
    """One parameter that matters."""

    change: JudgedChange
    used: str
    """Used share of the tolerance, U included; empty where it is not observed."""


@dataclass(frozen=True)
class StatusPaper:
    """Everything that the page says."""

    unit: str
    day: str
    key: str
    """Key of the colour of the use."""
    use: str
    why: str
    condition: Condition
    next: str
    """Due date of its next calibration; empty where something else must be done first."""
    facts: tuple[Fact, ...]
    reservations: tuple[str, ...]
    more: int
    """Reservations that have no room."""
    rows: tuple[StatusRow, ...]
    of: int
    """Parameters that were judged."""
    software: str
    simulated: bool


def status_paper(store: Store, serial: str, now: datetime) -> StatusPaper:
    """The page of a unit; NotFoundError when there is none."""
    unit = Fleet(store).get(serial)
    use = usable_of(store, (unit,), now)[serial]
    session = None if unit.last_session is None else Sessions(store).get(unit.last_session)
    decisions = () if session is None or session.is_reference else Sessions(store).decisions(session.id)
    said = (*use.reasons[1:], *use.reservations)
    return StatusPaper(
        unit=serial,
        day=day_of(now),
        key=TONES[use.answer],
        use=use.use,
        why=use.why,
        condition=condition_of(unit.verdict, is_reference=unit.is_reference),
        next="" if use.due is None else next_in_words(use),
        facts=tuple(_facts(unit, use, session)),
        reservations=said[:MOST_RESERVATIONS],
        more=max(0, len(said) - MOST_RESERVATIONS),
        rows=tuple(_row(decision) for decision in closest(decisions)),
        of=len(decisions),
        software=VERSION,
        simulated=unit.simulated,
    )


def closest(decisions: tuple[Decision, ...]) -> tuple[Decision, ...]:
    """The decisions that matter, the worst first, then by least margin to tolerance."""
    ranked = sorted(decisions, key=lambda d: (-d.verdict.severity, d.margin if d.margin is not None else 0.0))
    return tuple(ranked[:MOST_PARAMETERS])


def _row(decision: Decision) -> StatusRow:
    used = "" if decision.margin is None else f"{number(100 * (1 - decision.margin), 0)}{THIN}%"
    return StatusRow(moved(decision), used)


def _facts(unit: UnitSummary, use: Usable, session: StoredSession | None) -> list[Fact]:
    custody = (("Owner", unit.owner), ("Location", unit.location), ("Custodian", unit.custodian))
    found = [Fact("Type", unit.unit_type, is_written=True)]
    found += [Fact(name, value, is_written=True) for name, value in custody if value]
    if unit.retired_at is not None:
        found.append(Fact("Retired since", day_of(unit.retired_at)))
    if session is not None:
        found.append(Fact("Latest session", day_of(session.started_at)))
        found.append(Fact("Method", session.programme.replace("-", " ")))
        found.append(Fact("Session", session.id, is_written=True))
        if session.stand:
            found.append(Fact("Stand", session.stand, is_written=True))
    if use.due is not None:
        found.append(Fact("Why due then", use.due_reason))
    return found


def status_pdf(paper: StatusPaper, now: datetime, language: Language = Language.ENGLISH) -> bytes:
    """The page, A4."""
    return typeset(TEMPLATE, paper, now, language)
