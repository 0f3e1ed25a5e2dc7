"""Exports to flight controllers and robots over HTTP."""

from typing import Annotated

from fastapi import APIRouter, Query, Response

from estimator.json_object import Json
from service.papers.onboard import FORMS, System
from service.papers.onboard.given import check, given_of
from service.people.dependencies import StorageOf
from service.sessions.store import Sessions
from service.web.dependencies import Now
from service.web.fields import SessionId
from service.web.files import as_file
from service.web.problem_document import errors
from service.work.dependencies import ReaderOf

router = APIRouter(prefix="/sessions", tags=["handing on"])
PLAIN = "text/plain; charset=utf-8"
TEXT_FILE: dict[int | str, Json] = {200: {"content": {"text/plain": {"schema": {"type": "string"}}}}}


@router.get("/{id}/export", responses={**TEXT_FILE, **errors(404, 409, 422)}, response_class=Response)
def read_export(
    id: SessionId,
    storage: StorageOf,
    now: Now,
    reader: ReaderOf,
    system: Annotated[System, Query(description="PX4, ArduPilot, Kalibr or ROS 2.", examples=["px4"])],
    *,
    force: Annotated[bool, Query(description="Also where the unit must not be used; the file says so.")] = False,
) -> Response:
    """The correction as another system's parameters, with what that system cannot hold and what must be known of the
    unit; 409 where it must not be used, unless it is forced."""
    with storage.database.reading() as store:
        unit = Sessions(store).get(id).unit
    reader.until_dated(unit)
    given, form = given_of(storage, id, now), FORMS[system]
    if not force:
        check(given)
    name = f"{given.unit}-{given.session[:8]}-{system}.{form.ending}"
    return as_file(form.written(given).encode(), PLAIN, name)
