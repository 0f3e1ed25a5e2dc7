"""The forms of what happened to a unit: services, notes, sessions as found and as left."""

from datetime import datetime
from typing import Annotated, Literal
from urllib.parse import quote

from fastapi import APIRouter, Form
from fastapi.responses import RedirectResponse
from pydantic import AfterValidator

from service.dependencies import Now, ReceptionOf, StorageOf
from service.flows.add_note import add_note
from service.flows.record_service import record_service
from service.flows.set_stage import set_stage
from service.flows.withdraw_note import withdraw_note
from service.pages.forms import NO_NUL, SEE_OTHER, By, Key, Number, Why
from service.records.event import NewService
from service.records.instants import in_utc

router = APIRouter(include_in_schema=False)

At = Annotated[Annotated[datetime, AfterValidator(in_utc)] | None, Form()]
"""A time in UTC; left empty it is now."""
Kind = Annotated[Literal["adjustment", "repair", "sensor-swap", "reference", "service"], Form()]


@router.post("/units/{serial:path}/services")
def add_service(
    serial: Key,
    kind: Kind,
    by: By,
    reception: ReceptionOf,
    now: Now,
    *,
    at: At = None,
    sensor: Annotated[str, Form(max_length=200, pattern=NO_NUL)] = "",
    note: Annotated[str, Form(max_length=2000, pattern=NO_NUL)] = "",
) -> RedirectResponse:
    """Records what was done to the unit."""
    new, k = NewService(kind, at or now, note, by, sensor), reception.coverage_factor
    record_service(reception.storage, serial, new, now, coverage_factor=k)
    reception.ring()
    return _unit(serial, "events")


@router.post("/units/{serial:path}/notes")
def write_note(serial: Key, text: Why, by: By, storage: StorageOf, now: Now, *, at: At = None) -> RedirectResponse:
    """Keeps a remark."""
    add_note(storage, serial, text, at=at or now, who=by, now=now)
    return _unit(serial, "events")


@router.post("/notes/{id}/withdraw")
def withdraw(id: Number, by: By, why: Why, storage: StorageOf, now: Now) -> RedirectResponse:
    """A remark no longer holds."""
    return _unit(withdraw_note(storage, id, by, why, now).unit, "events")


@router.post("/sessions/{id}/stage")
def mark_session(
    id: Key, stage: Annotated[Literal["as-found", "as-left", "neither"], Form()], by: By, storage: StorageOf, now: Now
) -> RedirectResponse:
    """The session shows its unit as found, as left, or neither."""
    set_stage(storage, id, None if stage == "neither" else stage, by, now)
    return RedirectResponse(f"/sessions/{id}#stage", SEE_OTHER)


def _unit(serial: str, place: str) -> RedirectResponse:
    return RedirectResponse(f"/units/{quote(serial)}#{place}", SEE_OTHER)
