"""What the sessions of a unit, a unit type or a stand show together."""

import json

from fastapi import APIRouter, Response
from fastapi.responses import JSONResponse

from service.api.schemas.fields import Serial, StandName, TypeName
from service.api.schemas.groups import PENDING, GroupDocument
from service.api.schemas.problem import errors
from service.dependencies import GroupReaderOf
from service.errors import NotFoundError
from service.records.group import GroupAnswer, Level

router = APIRouter(tags=["diagnosis"])
RETRY_AFTER = "5"
"""Seconds: what a group of some tens of sessions takes."""
ANSWERS = {**PENDING, **errors(404, 422)}


@router.get("/units/{serial:path}/diagnosis", responses=ANSWERS, response_model=GroupDocument)
def read_unit_diagnosis(serial: Serial, groups: GroupReaderOf) -> Response | GroupDocument:
    """What the sessions of a unit since its last service show together, imu-fleet-diagnosis/1; waits some seconds."""
    return _answer(groups.read(Level.UNIT, serial), Level.UNIT, serial)


@router.get("/unit-types/{name:path}/diagnosis", responses=ANSWERS, response_model=GroupDocument)
def read_unit_type_diagnosis(name: TypeName, groups: GroupReaderOf) -> Response | GroupDocument:
    """What the sessions of all units of a type show together, imu-fleet-diagnosis/1; waits some seconds."""
    return _answer(groups.read(Level.TYPE, name), Level.TYPE, name)


@router.get("/stands/{name:path}/diagnosis", responses=ANSWERS, response_model=GroupDocument)
def read_stand_diagnosis(name: StandName, groups: GroupReaderOf) -> Response | GroupDocument:
    """What the sessions on a stand show together, imu-fleet-diagnosis/1; waits some seconds."""
    return _answer(groups.read(Level.STAND, name), Level.STAND, name)


def _answer(found: GroupAnswer | None, level: Level, name: str) -> Response | GroupDocument:
    if found is None:
        body = {"level": level.value, "id": name, "status": "pending"}
        return JSONResponse(body, 202, {"Retry-After": RETRY_AFTER})
    if found.document is None:
        raise NotFoundError(found.summary)
    made = {name: getattr(found, name) for name in ("summary", "estimator_version", "created_at")}
    return GroupDocument(**json.loads(found.document), **made)
