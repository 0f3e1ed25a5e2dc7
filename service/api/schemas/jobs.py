"""Long work, as programs ask for it and follow it."""

from collections.abc import Sequence
from datetime import datetime
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from estimator.errors import Problem
from service.api.schemas.fields import Text
from service.api.schemas.problem import Fault
from service.records.arrival import under_way
from service.records.failure import FailedKind
from service.records.job import Job, JobKind, JobState
from service.records.model import Scope


class NewRecalibration(BaseModel):
    """Stored sessions that are to be computed again under the models in force."""

    model_config = ConfigDict(extra="forbid")
    scope: Scope | None = Field(None, description="One unit, one unit type or one stand; none for the whole fleet.")
    subject: Text = Field("", description="Its serial number or name; empty for the whole fleet.")
    by: Text = Field("", description="Who asks, where nobody signs in.")


class FailedWorkSchema(BaseModel):
    """One piece of work beside the requests that has failed."""

    model_config = ConfigDict(from_attributes=True)
    kind: FailedKind = Field(description="What is done.")
    of: str = Field(description="Session, unit, group, job or address.")
    why: str = Field(description="Why it failed, in short; the log says more.")


class FailedWorkPage(BaseModel):
    """Work beside the requests that has failed."""

    counts: dict[FailedKind, int] = Field(description="How much of each kind; kinds without any are left out.")
    failed: list[FailedWorkSchema] = Field(description="By kind and name.")


class RetriedSchema(BaseModel):
    """What is tried again."""

    retried: int = Field(description="How many pieces of work.")


class NewReport(BaseModel):
    """A report of the whole fleet that is to be made."""

    model_config = ConfigDict(extra="forbid")
    format: Literal["xlsx", "pdf"] = Field(description="Workbook or paper.")
    by: Text = Field("", description="Who asks, where nobody signs in.")


class Cancelling(BaseModel):
    """Who cancels."""

    model_config = ConfigDict(extra="forbid")
    by: Text = Field("", description="Who cancels, where nobody signs in.")


class JobFailureSchema(BaseModel):
    """A piece of the work that could not be done."""

    model_config = ConfigDict(from_attributes=True)
    subject: str = Field(description="Serial number of the unit; empty for the whole.")
    reason: str = Field(description="Why, and what helps.")


class MadeSchema(BaseModel):
    """The file that a job made."""

    model_config = ConfigDict(from_attributes=True)
    filename: str = Field(description="Name for whoever keeps it.")
    size: int = Field(description="Bytes.")
    sha256: str = Field(description="SHA-256 of its content, hexadecimal.")
    until: datetime = Field(description="It is kept until then.")


class JobSchema(BaseModel):
    """Long work, as it stands."""

    model_config = ConfigDict(from_attributes=True)
    id: int = Field(description="Number of the job.")
    kind: JobKind = Field(description="What kind of work.")
    scope: Scope | None = Field(description="None for the whole fleet.")
    subject: str = Field(description="Serial number or name; of an upload the file's; empty for the whole fleet.")
    state: JobState = Field(description="How far it is.")
    who: str = Field(description="Who asked for it.")
    asked_at: datetime = Field(description="When it was asked for, UTC.")
    begun_at: datetime | None = Field(description="When it was begun, UTC; none while it waits.")
    ended_at: datetime | None = Field(description="When its last piece was begun, UTC; none while it is not ended.")
    cancelled_by: str = Field(description="Who cancelled it; empty where nobody did.")
    done: int = Field(description="Pieces that are whole: of a recalibration, units; of an upload, kilobytes read.")
    total: int = Field(description="Pieces in all.")
    times: int = Field(description="Of an upload: how often all of it was read already; a log is read several times.")
    recomputed: int = Field(description="Sessions that have another calibration since.")
    verdicts: int = Field(description="Sessions that have another verdict since.")
    failed: int = Field(description="Pieces that could not be done.")
    failures: list[JobFailureSchema] = Field(description="The first hundred of them.")
    held_up: str = Field(description="Why it waits although it was begun; empty where it does not.")
    made: MadeSchema | None = Field(description="What it made, at `/jobs/{id}/file`.")
    upload: str = Field(description="Of an upload: its id at `/uploads/{id}`, which tells what becomes of it.")
    session: str = Field(description="Of an upload: the session that it became; empty while it is none.")
    problems: list[Fault] = Field(description="Of an upload that was refused: every fault, where one job is read.")


class JobPage(BaseModel):
    """Jobs, the newest first."""

    jobs: list[JobSchema] = Field(description="The jobs of this page.")
    before: int | None = Field(description="Ask with it for the jobs before these; none where there are none.")


def job_schema(job: Job, problems: Sequence[Problem] = ()) -> JobSchema:
    """A job as the API tells of it, with the faults of the file that it refused."""
    own = {
        **vars(job),
        "times": job.cursor if job.kind is JobKind.UPLOAD else 0,
        "upload": under_way(job.id) if job.kind is JobKind.UPLOAD else "",
        "problems": [Fault(field=one.field, row=one.row, message=one.message) for one in problems],
    }
    return JobSchema.model_validate(own, from_attributes=True)
