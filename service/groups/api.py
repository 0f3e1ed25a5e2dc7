"""Joint diagnosis of the sessions of a unit, a unit type or a stand over HTTP."""

import json
from dataclasses import dataclass
from datetime import datetime
from typing import Annotated

from fastapi import APIRouter, Depends, Response
from fastapi.responses import JSONResponse
from pydantic import BaseModel, Field

from estimator.json_object import Json
from estimator.message import with_messages
from service.errors import NotFoundError
from service.groups.records import GroupAnswer, Level
from service.groups.store import Groups
from service.models.api import ModelDocument, model_document
from service.models.records import NewLasting
from service.people.admission import PersonOf
from service.records.dependencies import ReceptionOf
from service.records.models import accept_lasting
from service.records.recalibrate import recompute_beside
from service.web.dependencies import Now
from service.web.fields import Body, LongText, Name, Serial, StandName, TypeName
from service.web.problem_document import errors
from service.work.dependencies import GroupReaderOf


class NotPooled(BaseModel):
    """An accepted session that is not in the pool."""

    session: str = Field(description="Its id.")
    reason: str = Field(description="Why; empty where its file is lost, or it could not be diagnosed.")


class GroupDocument(BaseModel):
    """Joint diagnosis of the sessions of a unit, a unit type or a stand, imu-fleet-diagnosis/1."""

    format: str = Field(description="`imu-fleet-diagnosis/1`.")
    level: str = Field(description="`unit`, `type` or `stand`.")
    id: str = Field(description="Serial number of the unit, name of the type or stand.")
    sessions: int = Field(
        description="How many are pooled: accepted ones that calibrate a block. Of a stand also those of the same "
        "units elsewhere, which tell whose an effect is."
    )
    first: str | None = Field(description="Start of the oldest one; null without any.")
    last: str | None = Field(description="Start of the newest one; null without any.")
    findings: list[Json] = Field(
        description="Lasting effects: cause, level, subject, sensors (`*`: every one of a kind), amplitude and sigma "
        "in SI, spread between sessions, form (`same`, `varying`, `since`), since, e_value, strength, alternatives, "
        "rivals with what to measure, sentence, advice, and every session's own amplitude."
    )
    terms: list[Json] = Field(description="Empirical terms, learned where the catalogue ends.")
    unexplained: bool = Field(description="Whether the sessions share structure that no known cause explains.")
    structures: list[Json] = Field(description="Where that structure lives, and how strong it is.")
    limits: list[Json] = Field(
        description="Smallest amplitude of each cause that the pool would have found; `one_session`: its latest one."
    )
    gain: Json | None = Field(
        description="Prediction of the later sessions with and without the findings; null without findings. `before`, "
        "`after`: rms residual of every sensor in the latest session, SI, by kind and name."
    )
    e_value: float = Field(description="Evidence for anything beside the findings; a name needs 100.")
    notes: list[str] = Field(description="What else is worth knowing.")
    left_out: int = Field(description="Older sessions that are not pooled: the newest 60 are.")
    not_pooled: list[NotPooled] = Field(description="Newer ones that are not, and why.")
    summary: str = Field(description="The same in one line.")
    estimator_version: str = Field(description="Version of the program that made it.")
    created_at: datetime = Field(description="When, UTC.")


class NewLastingSchema(
    Body, json_schema_extra={"example": {"cause": "beta-eccentricity", "by": "K. Ito", "note": "encoder"}}
):
    """A lasting effect that an engineer accepts into the model of the unit, the unit type or the stand that has it."""

    cause: Name = Field(description="Identifier of a cause that the sessions show together.")
    sensors: list[Name] = Field(
        default=[], description="Of the finding, where the cause alone does not say which one is meant."
    )
    by: Name = Field(description="Who accepts it.")
    note: LongText = Field(default="", description="Why.")


class PendingGroup(BaseModel):
    """An answer that is still being made."""

    level: str = Field(description="`unit`, `type` or `stand`.")
    id: str = Field(description="Serial number of the unit, name of the type or stand.")
    status: str = Field(description="`pending`: ask again after the seconds in Retry-After.")


PENDING: dict[int | str, Json] = {
    202: {"model": PendingGroup, "description": "Still being made; ask again after Retry-After seconds."}
}
"""OpenAPI description of the answer while it is being made."""


router = APIRouter(tags=["diagnosis"])
RETRY_AFTER = "5"
"""Seconds until a retry: the time for a group of some tens of sessions."""
ANSWERS = {**PENDING, **errors(404, 422)}
ACCEPTED = errors(400, 404, 409, 422)


@dataclass(frozen=True)
class Accepting:
    """Accepts findings of a group, with its stores, the time and the person."""

    groups: GroupReaderOf
    reception: ReceptionOf
    now: Now
    person: PersonOf

    def accepted(self, level: Level, name: str, new: NewLastingSchema) -> ModelDocument:
        """The revision, once the group's answer is of its sessions of now."""
        storage = self.reception.storage
        self.groups.read(level, name)
        with storage.database.reading() as store:
            group = Groups(store).find(level, name)
        wanted = NewLasting(new.cause, tuple(new.sensors), self.person.signs(new.by), new.note)
        revision = accept_lasting(storage, group, wanted, self.now)
        recompute_beside(self.reception, self.now)
        return model_document(revision)


AcceptingOf = Annotated[Accepting, Depends()]


@router.get("/units/{serial:path}/diagnosis", responses=ANSWERS, response_model=GroupDocument)
def read_unit_diagnosis(serial: Serial, groups: GroupReaderOf) -> Response | GroupDocument:
    """Joint diagnosis of the sessions of a unit since its last service, imu-fleet-diagnosis/1; waits some seconds."""
    return _answer(groups.read(Level.UNIT, serial), Level.UNIT, serial)


@router.get("/unit-types/{name:path}/diagnosis", responses=ANSWERS, response_model=GroupDocument)
def read_unit_type_diagnosis(name: TypeName, groups: GroupReaderOf) -> Response | GroupDocument:
    """Joint diagnosis of the sessions of all units of a type, imu-fleet-diagnosis/1; waits some seconds."""
    return _answer(groups.read(Level.TYPE, name), Level.TYPE, name)


@router.get("/stands/{name:path}/diagnosis", responses=ANSWERS, response_model=GroupDocument)
def read_stand_diagnosis(name: StandName, groups: GroupReaderOf) -> Response | GroupDocument:
    """Joint diagnosis of the sessions on a stand, imu-fleet-diagnosis/1; waits some seconds."""
    return _answer(groups.read(Level.STAND, name), Level.STAND, name)


@router.post("/units/{serial:path}/diagnosis/accept", status_code=201, responses=ACCEPTED)
def accept_for_unit(serial: Serial, new: NewLastingSchema, accepting: AcceptingOf) -> ModelDocument:
    """Accept an effect common to a unit's sessions into its model; every session that it concerns is computed again."""
    return accepting.accepted(Level.UNIT, serial, new)


@router.post("/unit-types/{name:path}/diagnosis/accept", status_code=201, responses=ACCEPTED)
def accept_for_unit_type(name: TypeName, new: NewLastingSchema, accepting: AcceptingOf) -> ModelDocument:
    """Accept an effect common to the sessions of a unit type into its model; every session that it concerns is computed
    again.
    """
    return accepting.accepted(Level.TYPE, name, new)


@router.post("/stands/{name:path}/diagnosis/accept", status_code=201, responses=ACCEPTED)
def accept_for_stand(name: StandName, new: NewLastingSchema, accepting: AcceptingOf) -> ModelDocument:
    """Accept an effect common to the sessions on a stand into its model; every session that it concerns is computed
    again.
    """
    return accepting.accepted(Level.STAND, name, new)


def _answer(found: GroupAnswer | None, level: Level, name: str) -> Response | GroupDocument:
    if found is None:
        body = {"level": level.value, "id": name, "status": "pending"}
        return JSONResponse(body, 202, {"Retry-After": RETRY_AFTER})
    if found.document is None:
        raise NotFoundError(found.summary)
    made = {name: getattr(found, name) for name in ("summary", "estimator_version", "created_at")}
    return GroupDocument(**with_messages(json.loads(found.document)), **made)
