"""The addresses of the pages: each route reads or asks a flow, and renders a frozen context."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse

from estimator.allan.results import TERMS
from service.diagnosis.store import Diagnoses
from service.errors import NotFoundError
from service.flags.store import FlagQuery, Flags
from service.fleet.condition import UnitSummary
from service.fleet.store import Fleet
from service.fleet.uses_store import Uses
from service.fleet.wanted_store import Announcements
from service.groups.records import Level
from service.groups.sections import MOST_FOUND, found_line, group_section
from service.ingest import is_own_layout
from service.judging.reference import covered_at
from service.judging.usable_reading import usable_of
from service.kit.arriving_files import where
from service.kit.filling import Filling
from service.kit.limits import in_force
from service.models.rules import model_as_of
from service.models.store import Models
from service.outlook.reading import dated
from service.outlook.rules.populations import fleet_standouts
from service.outlook.store import Outlooks
from service.pages.courses import HISTORY_LIMIT
from service.pages.fleet.pages import MOST_STANDOUTS, fleet_page
from service.pages.fleet.view import FleetView
from service.pages.session.pages import session_page
from service.pages.unit.pages import unit_page
from service.pages.unit.parameters import parameter_heads, parameter_page
from service.pages.unit.remarks import remarks
from service.pages.unit.report import covered_now, unit_report
from service.papers.certified import recent_history, session_report, traceability_of
from service.papers.found_and_left import found_and_left
from service.people.admission import PersonOf
from service.people.dependencies import Key, StorageOf
from service.planning.pattern import type_names
from service.queue.store import PendingWork
from service.queue.words import pending_in_words
from service.records.dependencies import ReceptionOf
from service.records.register import retired_in_words
from service.sessions.calibrations_store import Calibrations
from service.sessions.doubt import Remedies
from service.sessions.history_store import History, HistoryQuery
from service.sessions.records import HistoryPoint
from service.sessions.states import RecordState
from service.sessions.store import Sessions
from service.storage.queries import Store
from service.types.store import UnitTypes
from service.units.remarks_store import SaidOf
from service.units.store import Register, Units
from service.uploads.correct import remedies_of
from service.uploads.layout.form import carried
from service.uploads.pages import job_outcome, looked_at, outcome_of, outcomes_of, table_outcome, upload_page
from service.uploads.receive import receive_all
from service.uploads.received import ChosenOf
from service.uploads.take_in import is_long
from service.web.application import application_of
from service.web.dependencies import Now, Reading, SettingsOf
from service.web.render import SOONEST, follow_seconds, render
from service.work.dependencies import JobDeskOf, ReaderOf, ReadingFleet

MOST_QUESTIONED = 20
"""Sessions that the fleet page names; the latest."""
FLAG_LIMIT = 50
"""Flags of a unit that its page lists: open ones, then the newest of those that are resolved."""

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.get("/")
def show_fleet(request: Request, store: ReadingFleet, now: Now, view: Annotated[FleetView, Query()]) -> HTMLResponse:
    """The fleet, worst unit first unless another order is asked for."""
    filling = application_of(request).find(Filling)
    being_filled = "" if filling is None else filling.in_words
    announced = Announcements(store).all(MOST_QUESTIONED, MOST_FOUND)
    condition, units = Fleet(store).condition_at(now), Fleet(store).units(view.query(now))
    shown = fleet_page(
        condition,
        units,
        usable_of(store, units, now),
        view,
        used=Uses(store).at(now),
        overdue=condition.overdue,
        together=found_line(announced),
        unlike=fleet_standouts(store, MOST_STANDOUTS),
        stands=announced.stands,
        questioned=announced.questioned,
        choices=Fleet(store).choices(),
        pending=being_filled or pending_in_words(PendingWork(store).counts()),
        follow=SOONEST if being_filled else None,
    )
    return render(request, "fleet.html", shown)


def _worst_of(store: Store, unit: UnitSummary) -> tuple[HistoryPoint, ...]:
    """The history of the parameter that sets a unit's verdict."""
    if unit.worst_sensor is None or unit.worst_parameter is None:
        return ()
    wanted = HistoryQuery(parameter=unit.worst_parameter, sensor=unit.worst_sensor)
    return recent_history(store, unit.serial, HISTORY_LIMIT, wanted)


@router.get("/units/{serial:path}/parameters/{name}")
def show_parameter(request: Request, store: Reading, serial: Key, name: Key, raw: bool = False) -> HTMLResponse:
    """Shows the history of one parameter of all sensors of a kind; ``raw``: with the common motion of the whole block
    left in.
    """
    heads = parameter_heads(History(store).latest(Units(store).key(serial)), None)
    head = next((head for head in heads if head.anchor == name), None)
    if head is None:
        raise NotFoundError("Unit {serial} has no history of {name}.", serial=serial, name=repr(name))
    wanted = HistoryQuery(parameter=head.parameter, kind=head.kind, raw=raw)
    points = recent_history(store, serial, HISTORY_LIMIT, wanted)
    outlook = Outlooks(store).of_unit(serial)
    page = parameter_page(serial, head, points, HISTORY_LIMIT, SaidOf(store).unit(serial), outlook, raw=raw)
    return render(request, "parameter.html", page)


@router.get("/units/{serial:path}")
def show_unit(
    request: Request,
    store: Reading,
    reader: ReaderOf,
    settings: SettingsOf,
    now: Now,
    *,
    serial: Key,
    raw: bool = False,
) -> HTMLResponse:
    """Shows one unit; ``raw``: histories of its parameters with the common motion of the whole block left in."""
    reader.look_at_unit(serial)
    report = unit_report(store, serial, now)
    latest = History(store).latest(Units(store).key(serial))
    is_heard = any(point.parameter in TERMS for point in latest)
    is_judged_later = report.waiting and not report.summary.failed
    is_pending = report.summary.is_undated and not report.summary.failed
    return render(
        request,
        "unit.html",
        unit_page(
            report,
            latest,
            usable_of(store, (report.summary,), now)[serial],
            raw=raw,
            noise=recent_history(store, serial, HISTORY_LIMIT, HistoryQuery(noise=True)) if is_heard else (),
            worst=_worst_of(store, report.summary),
            flags=Flags(store).page(FlagQuery(serial, limit=FLAG_LIMIT)),
            notes=report.said.notes,
            pair=found_and_left(store, report.unit_type, report.sessions, settings.coverage_factor),
            outlook=dated(report.outlook, now),
            group=group_section(store, Level.UNIT, serial),
            follow=SOONEST if is_judged_later or (is_pending and settings.diagnosis_workers) else None,
            said=remarks(serial, "", (), report.said.files, in_force().attached),
            history_of_custody=Register(store).history(serial),
            temperatures=covered_now(store, report),
            types=UnitTypes(store).alike(report.unit_type),
        ),
    )


@router.get("/sessions/{id}")
def show_session(
    request: Request, store: Reading, storage: StorageOf, reader: ReaderOf, settings: SettingsOf, now: Now, *, id: Key
) -> HTMLResponse:
    """One session with its parameters and residuals."""
    reader.look_at(id)
    report = session_report(store, id)
    made, said = report.diagnosis, SaidOf(store).session(report.session.unit, id)
    questioned = report.session.state is RecordState.QUESTIONED
    failed, of_type = "" if made else report.failed, UnitTypes(store).of_unit(report.session.unit)
    page = session_page(
        report,
        made,
        traceability_of(store, report.session),
        remedies=remedies_of(store, storage.files, id, report.states) if questioned else Remedies(),
        failed=failed,
        follow=None if made or failed else follow_seconds(report.session.uploaded_at, now, settings.diagnosis_workers),
        model=model_as_of(Models(store).of_session(id), report.session.revision),
        computed=Calibrations(store).revisions(id),
        retired=retired_in_words(Register(store).get(report.session.unit)),
        said=remarks(report.session.unit, id, said.notes, said.files, in_force().attached),
        temperatures=covered_at(store, report.session),
        no_tolerances="" if of_type.are_entered else of_type.name,
    )
    return render(request, "session.html", page)


@router.get("/sessions/{id}/outcome")
def show_outcome(request: Request, store: Reading, reader: ReaderOf, settings: SettingsOf, id: Key) -> HTMLResponse:
    """Shows the present outcome of an upload, as the card of the upload page."""
    reader.look_at(id)
    session = Sessions(store).get(id)
    outcome = outcome_of(session, Diagnoses(store).summary(id), retired_in_words(Register(store).get(session.unit)))
    return render(request, "outcome.html", upload_page((outcome,), settings))


@router.get("/upload")
def show_upload(request: Request, store: Reading, settings: SettingsOf) -> HTMLResponse:
    """The form."""
    return render(request, "upload.html", upload_page((), settings, type_names(store)))


@router.post("/upload")
def take_uploads(
    request: Request,
    chosen: ChosenOf,
    reception: ReceptionOf,
    settings: SettingsOf,
    now: Now,
    desk: JobDeskOf,
    person: PersonOf,
) -> HTMLResponse:
    """Shows the form with the verdict of each file, or its problems; 422 when a file cannot be used. Large files are
    processed by jobs. Of files that are only looked at it shows what is missing.
    """
    tables = [file for file in chosen.files if is_own_layout(where(file.content), file.filename)]
    whole = [file for file in chosen.files if file not in tables]
    looked = [looked_at(reception.storage, file) for file in whole] if chosen.is_only_looked_at else []
    whole = [] if chosen.is_only_looked_at else whole
    long = [file for file in whole if is_long(reception.storage, file, in_force().later)]
    sessions = [file for file in whole if file not in long]
    jobs = [job_outcome(desk.take_in(reception, file, person)) for file in long]
    found = receive_all(reception, sessions, now)
    kept = reception.storage.files
    asked = [table_outcome(file, carried(kept, person.login, file, now)) for file in tables]
    with reception.storage.database.reading() as store:
        outcomes = (*asked, *looked, *jobs, *outcomes_of(sessions, found, Diagnoses(store).summary))
        names = type_names(store)
    page = upload_page(outcomes, settings, names)
    return render(request, "upload.html", page, 422 if page.refused else 200)
