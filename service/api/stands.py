"""Stands: their own health."""

from fastapi import APIRouter

from service.api.schemas.problem import errors
from service.api.schemas.stands import StandList, StandSchema
from service.dependencies import Reading
from service.views.stands import stand_conditions

router = APIRouter(prefix="/stands", tags=["stands"])


@router.get("", responses=errors())
def list_stands(store: Reading) -> StandList:
    """Every stand: whether it shifts all units that are measured on it, since when, by how much."""
    return StandList(stands=[StandSchema.model_validate(found) for found in stand_conditions(store)])
