"""What the sessions of a unit, a unit type or a stand show together."""

import json
from dataclasses import dataclass
from typing import Annotated

from fastapi import APIRouter, Depends, Response
from fastapi.responses import JSONResponse

from service.admission import PersonOf
from service.api.schemas.fields import Serial, StandName, TypeName
from service.api.schemas.groups import PENDING, GroupDocument, NewLastingSchema
from service.api.schemas.models import ModelDocument, model_document
from service.api.schemas.problem import errors
from service.dependencies import GroupReaderOf, Now, ReceptionOf
from service.errors import NotFoundError
from service.flows.accept_lasting import accept_lasting
from service.flows.recompute import recompute_beside
from service.records.group import GroupAnswer, Level
from service.records.model import NewLasting

router = APIRouter(tags=["diagnosis"])
RETRY_AFTER = "5"
"""Seconds: what a group of some tens of sessions takes."""
ANSWERS = {**PENDING, **errors(404, 422)}
ACCEPTED = errors(400, 404, 409, 422)


@dataclass(frozen=True)
class Accepting:
    """What accepting takes beside what is accepted."""

    groups: GroupReaderOf
    reception: ReceptionOf
    now: Now
    person: PersonOf

    def accepted(self, level: Level, name: str, new: NewLastingSchema) -> ModelDocument:
        """The revision, once the group's answer is of its sessions of now."""
        storage = self.reception.storage
        self.groups.read(level, name)
        with storage.database.reading() as store:
            group = store.groups.find(level, name)
        wanted = NewLasting(new.cause, tuple(new.sensors), self.person.signs(new.by), new.note)
        revision = accept_lasting(storage, group, wanted, self.now)
        recompute_beside(self.reception, self.now)
        return model_document(revision)


AcceptingOf = Annotated[Accepting, Depends()]


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


@router.post("/units/{serial:path}/diagnosis/accept", status_code=201, responses=ACCEPTED)
def accept_for_unit(serial: Serial, new: NewLastingSchema, own: AcceptingOf) -> ModelDocument:
    """Accept what a unit's sessions show together; every session that it concerns is computed again."""
    return own.accepted(Level.UNIT, serial, new)


@router.post("/unit-types/{name:path}/diagnosis/accept", status_code=201, responses=ACCEPTED)
def accept_for_unit_type(name: TypeName, new: NewLastingSchema, own: AcceptingOf) -> ModelDocument:
    """Accept what the sessions of a type show together; every session that it concerns is computed again."""
    return own.accepted(Level.TYPE, name, new)


@router.post("/stands/{name:path}/diagnosis/accept", status_code=201, responses=ACCEPTED)
def accept_for_stand(name: StandName, new: NewLastingSchema, own: AcceptingOf) -> ModelDocument:
    """Accept what the sessions on a stand show together; every session that it concerns is computed again."""
    return own.accepted(Level.STAND, name, new)


def _answer(found: GroupAnswer | None, level: Level, name: str) -> Response | GroupDocument:
    if found is None:
        body = {"level": level.value, "id": name, "status": "pending"}
        return JSONResponse(body, 202, {"Retry-After": RETRY_AFTER})
    if found.document is None:
        raise NotFoundError(found.summary)
    made = {name: getattr(found, name) for name in ("summary", "estimator_version", "created_at")}
    return GroupDocument(**json.loads(found.document), **made)
