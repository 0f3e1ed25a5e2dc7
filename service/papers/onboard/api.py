"""Exports to flight controllers and robots over HTTP."""

from typing import Annotated

from fastapi import APIRouter, Query, Response

from estimator.json_object import Json
from service.papers.onboard import FORMS, System
from service.papers.onboard.stored import given_of
from service.people.dependencies import StorageOf
from service.web.fields import SessionId
from service.web.files import as_file
from service.web.problem_document import errors

router = APIRouter(prefix="/sessions", tags=["handing on"])
PLAIN = "text/plain; charset=utf-8"
TEXT_FILE: dict[int | str, Json] = {200: {"content": {"text/plain": {"schema": {"type": "string"}}}}}


@router.get("/{id}/export", responses={**TEXT_FILE, **errors(404, 409, 422)}, response_class=Response)
def read_export(
    id: SessionId,
    storage: StorageOf,
    system: Annotated[System, Query(description="PX4, ArduPilot, Kalibr or ROS 2.", examples=["px4"])],
) -> Response:
    """The correction as another system's parameters, with what that system cannot hold."""
    given, form = given_of(storage, id), FORMS[system]
    name = f"{given.unit}-{given.session[:8]}-{system}.{form.ending}"
    return as_file(form.written(given).encode(), PLAIN, name)
