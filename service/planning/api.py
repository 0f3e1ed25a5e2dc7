"""Plans: expected results of a session before it is measured."""

from typing import Annotated, Literal

from fastapi import APIRouter, Query
from pydantic import BaseModel, Field

from estimator.json_object import Json
from service.people.dependencies import StorageOf
from service.planning.question import PlanQuestion, ReadyQuestion
from service.planning.rules import missing_of, plan, readiness_of
from service.planning.words import missing_in_words, readiness_headline, reasons
from service.uploads.received import REQUEST_BODY, FileOf
from service.web.problem_document import errors

router = APIRouter(prefix="/plan", tags=["planning"])


class PlanDocument(BaseModel):
    """imu-plan/1: expected results of a session, SI; elevations in degrees."""

    model_config = {"extra": "allow"}

    format: str = Field(description="`imu-plan/1`.")
    question: Json = Field(description="What was asked, in people's units, with the type's tolerances.")


class Setting(BaseModel):
    """A position of the stand that is to come."""

    run: str = Field(description="`direct` or `flipped`.")
    beta_deg: float = Field(description="Turn of the head, degrees.")


class KnownSoFar(BaseModel):
    """Uncertainty of one parameter: total, one sigma, SI, relative for scale; null where it is not observed."""

    sensor: str = Field(description="Its name.")
    parameter: str = Field(description="`scale`, `bias`, `quadratic` or `axis`.")
    sigma: float | None = Field(description="By the positions so far.")
    complete: float | None = Field(description="By all positions of the programme.")


class MissingDocument(BaseModel):
    """imu-missing/1: the missing positions of a session that is being measured."""

    format: str = Field(description="`imu-missing/1`.")
    done: int = Field(description="Positions so far.")
    positions: int | None = Field(description="Equal steps a run; null in arbitrary orientations.")
    complete: bool = Field(description="Whether nothing is to come.")
    settings: list[Setting] = Field(description="Of a stand, in the order of turning.")
    directions: list[list[float]] = Field(description="Where up should point, unit vectors in block axes.")
    unseen: list[str] = Field(description="What the positions so far leave open.")
    expected: list[KnownSoFar] = Field(description="How well each parameter is known; empty without a stand.")
    said: list[str] = Field(description="The same for people.")


class ReadyDocument(BaseModel):
    """imu-readiness/1: whether a unit is warm and still enough, SI, times in s."""

    model_config = {"extra": "allow"}

    format: str = Field(description="`imu-readiness/1`.")
    state: str = Field(description="`ready`, `not-still`, `not-warm`, `too-early` or `cannot-tell`.")
    ready: bool = Field(description="Whether the measurement may begin.")
    unit_type: str | None = Field(description="By whose tolerances was judged; null: by the defaults.")
    said: list[str] = Field(description="The same for people: the answer, then its reasons.")


Positions = Annotated[
    int | None, Query(ge=2, le=360, description="Positions a run; without it the smallest step so far says it.")
]
Runs = Annotated[Literal["both", "direct"], Query(description="`direct` where the block is not flipped.")]


@router.post("/missing", responses=errors(400, 413, 422), openapi_extra=REQUEST_BODY)
def read_missing(file: FileOf, positions: Positions = None, runs: Runs = "both") -> MissingDocument:
    """The positions that a session under measurement still lacks. Nothing is stored."""
    found = missing_of(file, positions, both_runs=runs == "both")
    return MissingDocument.model_validate({**found.to_dict(), "said": missing_in_words(found)})


@router.post("/ready", responses=errors(400, 404, 413, 422), openapi_extra=REQUEST_BODY)
def read_ready(file: FileOf, asked: Annotated[ReadyQuestion, Query()], storage: StorageOf) -> ReadyDocument:
    """Whether a unit is warm and still enough, by the first rows or minutes of a record. Nothing is stored."""
    answer = readiness_of(storage, file, asked)
    said = [readiness_headline(answer.found), *reasons(answer.found, answer.kind)]
    return ReadyDocument(**answer.found.to_dict(), unit_type=answer.unit_type, said=said)


@router.get("", responses=errors(404, 422))
def read_plan(question: Annotated[PlanQuestion, Query()], storage: StorageOf) -> PlanDocument:
    """Elevation, positions, expected sigma of every parameter, what would be found and what cannot be seen."""
    asked, found = plan(storage, question)
    return PlanDocument(**found.to_dict(), question=asked.model_dump())
