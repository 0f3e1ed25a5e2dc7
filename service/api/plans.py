"""Plans: what a session would tell before it is measured."""

from typing import Annotated, Any

from fastapi import APIRouter, Query
from pydantic import BaseModel, Field

from service.api.schemas.problem import errors
from service.dependencies import StorageOf
from service.planning.question import PlanQuestion
from service.views.plan import plan

router = APIRouter(prefix="/plan", tags=["planning"])


class PlanDocument(BaseModel):
    """imu-plan/1: what a session would tell, SI; elevations in degrees."""

    model_config = {"extra": "allow"}

    format: str = Field(description="`imu-plan/1`.")
    question: dict[str, Any] = Field(description="What was asked, in people's units, with the type's tolerances.")


@router.get("", responses=errors(404, 422))
def read_plan(question: Annotated[PlanQuestion, Query()], storage: StorageOf) -> PlanDocument:
    """Elevation, positions, expected sigma of every parameter, what would be found and what cannot be seen."""
    asked, found = plan(storage, question)
    return PlanDocument(**found.to_dict(), question=asked.model_dump())
