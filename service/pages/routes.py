"""The addresses of the pages: each route reads or asks a flow, and renders a frozen context."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse

from service.admission import PersonOf
from service.dependencies import JobDeskOf, Now, Reading, ReadingFleet, ReceptionOf, SettingsOf, StorageOf
from service.flows.correct_session import remedies_of
from service.flows.receive import receive_all
from service.flows.take_in import is_long
from service.ingest import is_own_layout
from service.ingest.limits import in_force
from service.judging.model_in_force import model_as_of
from service.judging.standouts import fleet_standouts
from service.pages.fleet import MOST_STANDOUTS, fleet_page
from service.pages.fleet_view import FleetAsked, FleetView
from service.pages.follow import SOONEST, follow_seconds
from service.pages.forms import Key
from service.pages.group import MOST_FOUND, found_line, group_section
from service.pages.layout_form import carried
from service.pages.received import FormFiles
from service.pages.remarks import remarks
from service.pages.render import render
from service.pages.saved import saved
from service.pages.session import session_page
from service.pages.unit import unit_page
from service.pages.upload import job_outcome, outcome_of, outcomes_of, table_outcome, upload_page
from service.records.doubt import Remedies
from service.records.group import Level
from service.records.received import where
from service.records.saved_view import ListPage
from service.records.state import RecordState
from service.storage.queries.flags import FlagQuery
from service.views.found_and_left import found_and_left
from service.views.history import recent_history
from service.views.outlook import dated
from service.views.pattern import type_names
from service.views.session_report import session_report
from service.views.traceability import traceability_of
from service.views.unit_report import unit_report

MOST_QUESTIONED = 20
"""Sessions that the fleet page names; the latest."""
HISTORY_LIMIT = 10_000
"""Points of one unit's history that a page draws, of its newest sessions: 400 of six sensors, 50 of 48."""
FLAG_LIMIT = 50
"""Flags of a unit that its page lists: open ones, then the newest of those that are resolved."""

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.get("/")
def show_fleet(
    request: Request,
    store: ReadingFleet,
    now: Now,
    person: PersonOf,
    asked: Annotated[FleetAsked, Query()],
) -> HTMLResponse:
    """The fleet, worst unit first unless another order is asked for."""
    view, announced = FleetView.of(asked), store.announced.all(MOST_QUESTIONED, MOST_FOUND)
    condition = store.fleet.condition_at(now)
    shown = fleet_page(
        condition,
        store.fleet.units(view.query(now)),
        view,
        now,
        overdue=condition.overdue,
        together=found_line(announced),
        unlike=fleet_standouts(store, MOST_STANDOUTS),
        stands=announced.stands,
        questioned=announced.questioned,
        choices=store.fleet.choices(),
        kept=saved(store.saved_views.of(person.login, ListPage.FLEET), view, ListPage.FLEET, person),
    )
    return render(request, "fleet.html", shown)


@router.get("/units/{serial:path}")
def show_unit(
    request: Request,
    store: Reading,
    settings: SettingsOf,
    now: Now,
    serial: Key,
    raw: bool = False,
) -> HTMLResponse:
    """One unit with the history of its parameters; ``raw``: what the whole block did is left in."""
    report = unit_report(store, serial, now)
    is_judged_later = report.waiting and not report.summary.failed
    is_coming = report.summary.is_undated and not report.summary.failed
    return render(
        request,
        "unit.html",
        unit_page(
            report,
            recent_history(store, serial, HISTORY_LIMIT, raw=raw, noise=True),
            now=now,
            raw=raw,
            flags=store.flags.page(FlagQuery(serial, limit=FLAG_LIMIT)),
            notes=report.said.notes,
            pair=found_and_left(store, report.unit_type, report.sessions, report.services, settings.coverage_factor),
            outlook=dated(report.outlook, now),
            group=group_section(store, Level.UNIT, serial),
            follow=SOONEST if is_judged_later or (is_coming and settings.diagnosis_workers) else None,
            said=remarks(serial, "", (), report.said.files, in_force().attached),
        ),
    )


@router.get("/sessions/{id}")
def show_session(
    request: Request, store: Reading, storage: StorageOf, settings: SettingsOf, now: Now, id: Key
) -> HTMLResponse:
    """One session with its parameters and residuals."""
    report = session_report(store, id)
    made, said = report.diagnosis, store.said_of.session(report.session.unit, id)
    questioned = report.session.state is RecordState.QUESTIONED
    failed = "" if made else report.failed
    page = session_page(
        report,
        made,
        traceability_of(store, report.session),
        remedies=remedies_of(storage, id, report.states) if questioned else Remedies(),
        failed=failed,
        follow=None if made or failed else follow_seconds(report.session.uploaded_at, now, settings.diagnosis_workers),
        model=model_as_of(store.models.of_session(id), report.session.revision),
        computed=store.calibrations.revisions(id),
        said=remarks(
            report.session.unit,
            id,
            said.notes,
            said.files,
            in_force().attached,
        ),
    )
    return render(request, "session.html", page)


@router.get("/sessions/{id}/outcome")
def show_outcome(request: Request, store: Reading, settings: SettingsOf, id: Key) -> HTMLResponse:
    """What became of an upload by now, as the card of the upload page."""
    outcome = outcome_of(store.sessions.get(id), store.diagnoses.summary(id))
    return render(request, "outcome.html", upload_page((outcome,), settings))


@router.get("/upload")
def show_upload(request: Request, store: Reading, settings: SettingsOf) -> HTMLResponse:
    """The form."""
    return render(request, "upload.html", upload_page((), settings, type_names(store)))


@router.post("/upload")
def take_uploads(
    request: Request,
    files: FormFiles,
    reception: ReceptionOf,
    settings: SettingsOf,
    now: Now,
    desk: JobDeskOf,
    person: PersonOf,
) -> HTMLResponse:
    """The form with the verdict of each file, or what is wrong with it; 422 when a file cannot be used. Large files
    are worked on by jobs."""
    tables = [file for file in files if is_own_layout(where(file.content), file.filename)]
    whole = [file for file in files if file not in tables]
    long = [file for file in whole if is_long(reception.storage, file, in_force().later)]
    sessions = [file for file in whole if file not in long]
    jobs = [job_outcome(desk.take_in(reception, file, person)) for file in long]
    found = receive_all(reception, sessions, now)
    kept = reception.storage.files
    asked = [table_outcome(file, carried(kept, person.login, file, now)) for file in tables]
    with reception.storage.database.reading() as store:
        outcomes = (*asked, *jobs, *outcomes_of(sessions, found, store.diagnoses.summary))
        names = type_names(store)
    page = upload_page(outcomes, settings, names)
    return render(request, "upload.html", page, 422 if page.refused else 200)
