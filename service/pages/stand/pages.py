"""The pages of stands: permitted use of each today, and its condition by its units."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import date, datetime
from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, File, Form, Request, UploadFile
from fastapi.responses import HTMLResponse, RedirectResponse

from estimator.message import say
from service.flags.pages import FlagCard, flag_cards
from service.flags.records import AT_FAULT, Flag
from service.flags.store import FlagQuery, Flags
from service.fleet.condition import UnitSummary
from service.fleet.records import FleetQuery, Order
from service.fleet.store import Fleet
from service.groups.records import Level
from service.groups.sections import GroupSection, group_section
from service.judging.records import Usable
from service.judging.usable_reading import usable_of
from service.kit.measures import day_of
from service.models.records import ModelRevision, Scope
from service.models.rules import in_force
from service.models.sections import AcceptedCause, accepted_causes
from service.models.store import Models
from service.pages.fleet.pages import FleetRow, flags_in_words, fleet_row
from service.people.dependencies import SEE_OTHER, By, FormName, Key, StorageOf
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.sessions.lines import SessionLine, session_lines
from service.sessions.records import SessionQuery, StoredSession
from service.sessions.store import Sessions
from service.stands.changes import record_stand_certificate
from service.stands.dcc import read_dcc
from service.stands.records import StandCertificate, StandCondition, StandError, StandEvidence, StandUse
from service.stands.store import StandCertificates, Stands
from service.stands.words import (
    WORDS,
    StandWord,
    certificate_in_words,
    condition_in_words,
    error_in_words,
    held,
    kind_of_shift,
    scatter_of,
    size_of_shift,
    stand_word,
)
from service.storage.queries import Store
from service.web.dependencies import Now
from service.web.render import render
from service.work.dependencies import ReadingFleet

MOST = 25
"""Flags, sessions and units that the page of one stand lists: a screen of each; the lists themselves have all."""


@dataclass(frozen=True)
class StandLine:
    """One stand in the list."""

    use: StandUse
    condition: StandCondition | None
    """Condition by its units; None where no session shows it."""
    certificates: tuple[StandCertificate, ...]
    """Certificates, oldest issue first."""
    flags: int
    """Number of open flags that find it at fault."""
    is_pending: bool
    """Whether the stands' conditions are being worked out with the latest records."""


@dataclass(frozen=True)
class StandReport:
    """One stand; one flag, unit or session more than are listed says that there are others."""

    line: StandLine
    flags: tuple[Flag, ...]
    units: tuple[UnitSummary, ...]
    """Units whose latest session was measured on it, the latest first."""
    uses: Mapping[str, Usable]
    sessions: tuple[StoredSession, ...]
    """Sessions, newest first."""
    models: tuple[ModelRevision, ...]
    """Causes that engineers accepted into its model, and that hold."""
    errors: tuple[StandError, ...] = ()
    """Errors of the stand as stated by the certificate of today."""


def every_stand(store: Store) -> tuple[StandLine, ...]:
    """All stands, by name, in four queries."""
    certificates, flags = StandCertificates(store).every(), Flags(store).open_about(*AT_FAULT)
    is_pending = WorkQueue(store, WorkKind.SUMMARY).count() > 0
    return tuple(
        StandLine(
            use=known.use,
            condition=known.condition,
            certificates=certificates.get(known.use.stand, ()),
            flags=sum(flag.place == known.use.stand for flag in flags),
            is_pending=is_pending,
        )
        for known in Stands(store).every()
    )


def stand_report(store: Store, name: str, now: datetime) -> StandReport:
    """One stand; NotFoundError where there is none of that name."""
    known = Stands(store).one(name)
    flags = Flags(store).page(FlagQuery(unresolved=True, stand=name, limit=MOST + 1))
    units = Fleet(store).units(FleetQuery(stand=name, order=Order.LAST, backwards=True, limit=MOST + 1))
    at_fault = sum(flag.matter in AT_FAULT for flag in flags)
    certificates = StandCertificates(store).with_errors(name)
    valid = held(tuple(certificates), now.date())
    return StandReport(
        line=StandLine(
            known.use, known.condition, tuple(certificates), at_fault, WorkQueue(store, WorkKind.SUMMARY).count() > 0
        ),
        flags=flags,
        units=units,
        uses=usable_of(store, units, now),
        sessions=Sessions(store).wanted(SessionQuery(stand=name, limit=MOST + 1)),
        models=in_force(Models(store).of_subject(Scope.STAND, name)),
        errors=() if valid is None else certificates[valid],
    )


@dataclass(frozen=True)
class ListedStand:
    """One stand in the list."""

    use: StandUse
    word: StandWord
    condition: str
    certificate: str
    """Last day of traceable sessions, as a cell of a table."""
    flags: str


@dataclass(frozen=True)
class StandsPage:
    """Everything the list of stands shows."""

    rows: tuple[ListedStand, ...]
    """Stands that need action first, then by name."""


@dataclass(frozen=True)
class ShiftRow:
    """Evidence of the units on one quantity of the stand: a shift, or that there is none."""

    what: str
    size: str
    when: str
    units: str
    word: str
    tone: str


@dataclass(frozen=True)
class StandPage:
    """Contents of the page of one stand; of each list, one more would be on the next page."""

    use: StandUse
    word: StandWord
    reasons: tuple[str, ...]
    is_pending: bool
    """Whether what its units show is being worked out, and may change."""
    certificates: tuple[tuple[str, str, str, str], ...]
    """Number, issued by, issued on, valid until; the latest first."""
    errors: tuple[tuple[str, str], ...]
    """Errors stated by the certificate of today, and ± U."""
    flags: tuple[FlagCard, ...]
    shifts: tuple[ShiftRow, ...]
    seating: tuple[tuple[str, str], ...]
    """Quantity, and its scatter from one mounting to the next."""
    unreadable: tuple[str, ...]
    """Sessions without evidence on the stand, because their stored results cannot be used."""
    units: tuple[FleetRow, ...]
    sessions: tuple[SessionLine, ...]
    causes: tuple[AcceptedCause, ...]
    group: GroupSection | None
    more: tuple[str, ...]
    """Names among ``flags``, ``units`` and ``sessions`` of the lists that are cut."""


def stands_page(stands: Sequence[StandLine], now: datetime) -> StandsPage:
    """The list of stands."""
    rows = [_row(stand, now) for stand in stands]
    return StandsPage(tuple(sorted(rows, key=lambda row: (WORDS.index(row.word), row.use.stand))))


def stand_page(report: StandReport, now: datetime, group: GroupSection | None = None) -> StandPage:
    """The page of one stand."""
    line, condition = report.line, report.line.condition
    certificate = certificate_in_words(line.certificates, now.date())
    listed = {"flags": report.flags, "units": report.units, "sessions": report.sessions}
    return StandPage(
        use=line.use,
        word=_word(line, now),
        reasons=(certificate, condition_in_words(condition, is_pending=line.is_pending)),
        is_pending=line.is_pending,
        certificates=tuple(map(_certificate, reversed(line.certificates))),
        errors=tuple(map(error_in_words, report.errors)),
        flags=flag_cards(report.flags[:MOST]),
        shifts=() if condition is None else _shifts(condition),
        seating=() if condition is None else _seating(condition),
        unreadable=() if condition is None else condition.unreadable,
        units=tuple(fleet_row(unit, report.uses[unit.serial]) for unit in report.units[:MOST]),
        sessions=session_lines(report.sessions[:MOST]),
        causes=accepted_causes(report.models),
        group=group,
        more=tuple(name for name, found in listed.items() if len(found) > MOST),
    )


def _row(line: StandLine, now: datetime) -> ListedStand:
    latest = held(line.certificates, now.date())
    until = "none recorded" if latest is None else say("until {valid_until}", valid_until=day_of(latest.valid_until))
    return ListedStand(
        line.use,
        _word(line, now),
        condition_in_words(line.condition, is_pending=line.is_pending),
        until,
        flags_in_words(line.flags),
    )


def _word(line: StandLine, now: datetime) -> StandWord:
    return stand_word(line.condition, line.certificates, line.flags, now.date())


def _certificate(found: StandCertificate) -> tuple[str, str, str, str]:
    return found.number, found.issued_by, day_of(found.issued_on), day_of(found.valid_until)


def _shifts(condition: StandCondition) -> tuple[ShiftRow, ...]:
    """Shifts, newest first; then the most evident of every quantity that has none."""
    shifted = {(shift.kind, shift.quantity) for shift in condition.shifts}
    steady = [evidence for evidence in condition.evidence if (evidence.kind, evidence.quantity) not in shifted]
    return (*(_shift(evidence) for evidence in reversed(condition.shifts)), *(_steady(evidence) for evidence in steady))


def _shift(evidence: StandEvidence) -> ShiftRow:
    lasts = evidence.until is None
    when = (
        say("since {date}", date=day_of(evidence.since))
        if evidence.until is None
        else say("{start} to before {end}", start=day_of(evidence.since), end=day_of(evidence.until))
    )
    word, tone = ("shifted", "conditional-fail") if lasts else ("shift has ended", "conditional-pass")
    return _shift_row(evidence, when, word, tone)


def _steady(found: StandEvidence) -> ShiftRow:
    return _shift_row(
        found, say("most evident since {since}", since=day_of(found.since)), "stable: no significant change", "pass"
    )


def _shift_row(evidence: StandEvidence, when: str, word: str, tone: str) -> ShiftRow:
    units = say("{number} of {units}", number=evidence.agreeing, units=evidence.units)
    return ShiftRow(kind_of_shift(evidence.kind, evidence.quantity), size_of_shift(evidence), when, units, word, tone)


def _seating(condition: StandCondition) -> tuple[tuple[str, str], ...]:
    return tuple((kind_of_shift(seating.kind, seating.quantity), scatter_of(seating)) for seating in condition.seating)


router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)
Day = Annotated[date, Form()]


@router.get("/stands")
def show_stands(request: Request, store: ReadingFleet, now: Now) -> HTMLResponse:
    """Shows every stand, those that need action first."""
    return render(request, "stands.html", stands_page(every_stand(store), now))


@router.get("/stands/{name:path}")
def show_stand(request: Request, store: ReadingFleet, now: Now, name: Key) -> HTMLResponse:
    """One stand: may it be used today, and what was measured on it."""
    return render(
        request, "stand.html", stand_page(stand_report(store, name, now), now, group_section(store, Level.STAND, name))
    )


@router.post("/stands/{name:path}/certificates")
def record_certificate(
    name: Key,
    number: FormName,
    issued_by: FormName,
    issued_on: Day,
    valid_until: Day,
    *,
    by: By,
    storage: StorageOf,
    now: Now,
) -> RedirectResponse:
    """Keeps the certificate of the stand's calibration."""
    given = StandCertificate(name, number.strip(), issued_by.strip(), issued_on, valid_until)
    record_stand_certificate(storage, given, now, who=by)
    return _to_certificates(name)


@router.post("/stands/{name:path}/certificate-document")
def record_certificate_document(
    name: Key,
    document: Annotated[UploadFile, File()],
    *,
    by: By,
    valid_until: Annotated[date | None, Form()] = None,
    storage: StorageOf,
    now: Now,
) -> RedirectResponse:
    """Keeps what the stand's Digital Calibration Certificate says."""
    read = read_dcc(document.file.read(), name, valid_until)
    record_stand_certificate(storage, read.certificate, now, who=by, errors=read.errors)
    return _to_certificates(name)


def _to_certificates(name: str) -> RedirectResponse:
    return RedirectResponse(f"/stands/{quote(name)}#certificates", SEE_OTHER)
