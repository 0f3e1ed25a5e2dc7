"""The forms of records and services, and of the register: its page, and what enters, moves, retires and puts back."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Literal
from urllib.parse import quote

from fastapi import APIRouter, Form, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from pydantic import AfterValidator

from estimator.errors import Problem
from service.errors import RefusedError
from service.kit.moments import in_utc
from service.pages.unit.events import service_in_words
from service.people.dependencies import SEE_OTHER, By, FormLines, FormName, FormText, Key, Number, StorageOf, Why
from service.records.changes import (
    accept_session,
    choose_reference,
    record_service,
    set_mark,
    set_stage,
    withdraw_service,
    withdraw_session,
)
from service.records.dependencies import ReceptionOf, RegisterTurn
from service.records.preview import preview_service
from service.records.register import Entered, Entering, enter, move_unit
from service.records.register_api import import_register
from service.records.supersede import supersede_session
from service.records.unit_changes import add_note, withdraw_note
from service.records.unit_type import set_type
from service.sessions.records import MARKS
from service.sessions.sent import Replaced
from service.sessions.states import Step
from service.types.store import UnitTypes
from service.units.records import CustodyStep, Move, NewEntry, NewService, ServicePreview
from service.units.register_file import COLUMNS
from service.uploads.correct import correct_session
from service.uploads.receive import deriving
from service.uploads.received import SentOf
from service.web.dependencies import Now, Reading
from service.web.render import render

router = APIRouter(include_in_schema=False)


@router.post("/sessions/{id}/withdraw")
def withdraw(id: Key, by: By, why: Why, reception: ReceptionOf, now: Now) -> RedirectResponse:
    """A session is taken back."""
    withdraw_session(reception.storage, deriving(reception, now), id, Step(by, now, why))
    reception.ring()
    return RedirectResponse(f"/sessions/{id}", SEE_OTHER)


@router.post("/sessions/{id}/accept")
def accept(id: Key, by: By, why: Why, reception: ReceptionOf, now: Now) -> RedirectResponse:
    """A session counts."""
    accept_session(reception.storage, deriving(reception, now), id, Step(by, now, why))
    reception.ring()
    return RedirectResponse(f"/sessions/{id}", SEE_OTHER)


def _marking(word: str, name: str) -> Callable[..., RedirectResponse]:
    def mark(
        id: Key, by: By, why: Why, reception: ReceptionOf, now: Now, *, is_so: Annotated[bool, Form(alias=name)] = False
    ) -> RedirectResponse:
        set_mark(reception.storage, deriving(reception, now), id, Step(by, now, why), word, is_so=is_so)
        reception.ring()
        return RedirectResponse(f"/sessions/{id}#stage", SEE_OTHER)

    return mark


for mark in MARKS.items():
    router.post(f"/sessions/{{id}}/{mark[0]}")(_marking(*mark))


@router.post("/sessions/{id}/correct")
def correct(id: Key, by: By, reception: ReceptionOf, now: Now) -> RedirectResponse:
    """A corrected file is made from a questioned session's and supersedes it."""
    return RedirectResponse(f"/sessions/{correct_session(reception, id, by, now).id}", SEE_OTHER)


@router.post("/sessions/{id}/stand")
def stand(
    id: Key, session: FormName, by: By, why: Why,
    reception: ReceptionOf, now: Now,
) -> RedirectResponse:  # fmt: skip
    """A session supersedes another one of the same moment."""
    supersede_session(reception.storage, deriving(reception, now), Replaced(session, by, why), id)
    reception.ring()
    return RedirectResponse(f"/sessions/{id}", SEE_OTHER)


@router.post("/sessions/{id}/reference")
def choose(id: Key, by: By, why: Why, reception: ReceptionOf, now: Now) -> RedirectResponse:
    """A session is chosen as the reference of its epoch."""
    choose_reference(reception.storage, deriving(reception, now), id, Step(by, now, why))
    reception.ring()
    return RedirectResponse(f"/sessions/{id}", SEE_OTHER)


@router.post("/services/{id}/withdraw")
def withdraw_break(id: Number, by: By, why: Why, reception: ReceptionOf, now: Now) -> RedirectResponse:
    """A service is taken back."""
    service, _ = withdraw_service(reception.storage, deriving(reception, now), id, Step(by, now, why))
    reception.ring()
    return RedirectResponse(f"/units/{quote(service.unit)}#events", SEE_OTHER)


At = Annotated[Annotated[datetime, AfterValidator(in_utc)] | None, Form()]
"""A time in UTC; left empty it is now."""
Kind = Annotated[Literal["adjustment", "repair", "sensor-swap", "reference", "service"], Form()]


@dataclass(frozen=True)
class ForeseenPage:
    """A service that is still to be recorded."""

    service: NewService
    what: str
    """Service in words: `Repair of A3`."""
    preview: ServicePreview


@router.post("/units/{serial:path}/services")
def add_service(
    request: Request,
    serial: Key,
    kind: Kind,
    by: By,
    reception: ReceptionOf,
    now: Now,
    *,
    at: At = None,
    sensor: FormText = "",
    note: FormLines = "",
    sure: Annotated[bool, Form()] = False,
) -> Response:
    """Records a service of the unit; for one before stored sessions it first shows the changes."""
    new, k = NewService(kind, at or now, note, by, sensor), reception.coverage_factor
    if not sure and at is not None:
        foreseen = preview_service(reception.storage, deriving(reception, now), serial, new)
        if foreseen.is_late:
            return render(request, "service_preview.html", ForeseenPage(new, service_in_words(new), foreseen))
    record_service(reception.storage, serial, new, now, coverage_factor=k)
    reception.ring()
    return _events(serial)


@router.post("/units/{serial:path}/notes")
def write_note(serial: Key, text: Why, by: By, storage: StorageOf, now: Now, *, at: At = None) -> RedirectResponse:
    """Keeps a remark."""
    add_note(storage, serial, text, at=at or now, who=by, now=now)
    return _events(serial)


@router.post("/notes/{id}/withdraw")
def withdraw_note_form(id: Number, by: By, why: Why, storage: StorageOf, now: Now) -> RedirectResponse:
    """A remark no longer holds."""
    return _events(withdraw_note(storage, id, by, why, now).unit)


@router.post("/sessions/{id}/stage")
def mark_session(
    id: Key, stage: Annotated[Literal["as-found", "as-left", "neither"], Form()], by: By, storage: StorageOf, now: Now
) -> RedirectResponse:
    """The session shows its unit as found, as left, or neither."""
    set_stage(storage, id, None if stage == "neither" else stage, by, now)
    return RedirectResponse(f"/sessions/{id}#stage", SEE_OTHER)


def _events(serial: str) -> RedirectResponse:
    return RedirectResponse(f"/units/{quote(serial)}#events", SEE_OTHER)


MOST_TYPES = 500
"""Names that the form offers."""


@dataclass(frozen=True)
class RegisterPage:
    """The forms of the register, and the result of an import."""

    types: tuple[str, ...]
    entered: Entered | None = None
    refused: str = ""
    problems: tuple[Problem, ...] = ()
    columns: tuple[str, ...] = COLUMNS


@router.get("/register", response_class=HTMLResponse)
def show_register(request: Request, store: Reading) -> HTMLResponse:
    """The forms."""
    types = tuple(unit_type.name for unit_type in UnitTypes(store).page(0, MOST_TYPES))
    return render(request, "register.html", RegisterPage(types))


@router.post("/register")
def enter_unit(
    serial: FormName, unit_type: FormName, by: By, storage: StorageOf, now: Now,
    *, owner: FormText = "", location: FormText = "", custodian: FormText = "", note: FormLines = "",
) -> RedirectResponse:  # fmt: skip
    """Enters one unit."""
    texts = (text.strip() for text in (serial, unit_type, owner, location, custodian, note))
    entry = NewEntry(*texts)
    enter(storage, (entry,), Entering(by, now))
    return RedirectResponse(f"/units/{quote(entry.serial)}#register", SEE_OTHER)


@router.post("/register/import", response_class=HTMLResponse)
def import_units(request: Request, sent: SentOf, _: RegisterTurn, storage: StorageOf, now: Now) -> HTMLResponse:
    """Enters the units of a table; shows the page again with the result."""
    with storage.database.reading() as store:
        types = tuple(unit_type.name for unit_type in UnitTypes(store).page(0, MOST_TYPES))
    try:
        page = RegisterPage(types, import_register(storage, sent, now))
    except RefusedError as refusal:
        page = RegisterPage(types, None, refusal.detail, refusal.problems)
        return render(request, "register.html", page, refusal.status)
    return render(request, "register.html", page)


@router.post("/units/{serial:path}/moves")
def move(
    serial: Key, location: FormText, custodian: FormText, by: By, storage: StorageOf, now: Now,
    *, at: At = None, remark: FormLines = "",
) -> RedirectResponse:  # fmt: skip
    """Records where a unit is and who has it."""
    move_unit(storage, serial, Move(location.strip(), custodian.strip(), remark), by, now, at=at)
    return RedirectResponse(f"/units/{quote(serial)}#register", SEE_OTHER)


@router.post("/units/{serial:path}/retire")
def retire(serial: Key, by: By, why: Why, storage: StorageOf, now: Now, *, at: At = None) -> RedirectResponse:
    """Retires a unit."""
    move_unit(storage, serial, Move(remark=why, step=CustodyStep.RETIRED), by, now, at=at)
    return RedirectResponse(f"/units/{quote(serial)}", SEE_OTHER)


@router.post("/units/{serial:path}/type")
def move_to_type(
    serial: Key, unit_type: FormName, by: By, why: Why, reception: ReceptionOf, now: Now
) -> RedirectResponse:
    """Moves a unit to another type."""
    set_type(reception.storage, deriving(reception, now), serial, unit_type.strip(), Step(by, now, why))
    reception.ring()
    return RedirectResponse(f"/units/{quote(serial)}", SEE_OTHER)


@router.post("/units/{serial:path}/return")
def put_back(serial: Key, by: By, why: Why, storage: StorageOf, now: Now, *, at: At = None) -> RedirectResponse:
    """Puts a unit back into use."""
    move_unit(storage, serial, Move(remark=why, step=CustodyStep.RETURNED), by, now, at=at)
    return RedirectResponse(f"/units/{quote(serial)}", SEE_OTHER)
