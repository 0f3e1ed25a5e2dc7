"""Long work, as programs ask for it and follow it."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from estimator.errors import Problem
from service.api.schemas.fields import Text
from service.api.schemas.problem import Fault, faults
from service.records.answer import answer
from service.records.failure import Failed, FailedKind
from service.records.job import Job
from service.records.model import Scope


class NewRecalibration(BaseModel):
    """Stored sessions that are to be computed again under the models in force."""

    model_config = ConfigDict(extra="forbid")
    scope: Scope | None = Field(None, description="One unit, one unit type or one stand; none for the whole fleet.")
    subject: Text = Field("", description="Its serial number or name; empty for the whole fleet.")
    by: Text = Field("", description="Who asks, where nobody signs in.")


class FailedWorkPage(BaseModel):
    """Work beside the requests that has failed."""

    counts: dict[FailedKind, int] = Field(description="How much of each kind; kinds without any are left out.")
    failed: tuple[Failed, ...] = Field(description="By kind and name.")


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


@answer
@dataclass(frozen=True, kw_only=True)
class JobAnswer(Job):
    """Long work, as it stands."""

    problems: tuple[Fault, ...]
    """Of an upload that was refused: every fault, where one job is read."""


class JobPage(BaseModel):
    """Jobs, the newest first."""

    jobs: list[JobAnswer] = Field(description="The jobs of this page.")
    before: int | None = Field(description="Ask with it for the jobs before these; none where there are none.")


def job_answer(job: Job, problems: Iterable[Problem] = ()) -> JobAnswer:
    """A job as the API tells of it, with the faults of the file that it refused."""
    return JobAnswer(**vars(job), problems=tuple(faults(problems)))
