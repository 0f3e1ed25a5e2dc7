"""The fleet as a whole."""

from typing import Annotated, Literal

from fastapi import APIRouter, Query, Response

from service.api.exports import as_csv, fleet_table
from service.api.schemas.fields import Page, next_page
from service.api.schemas.problem import errors
from service.api.schemas.units import FleetSchema, UnitPage, UnitSummarySchema
from service.dependencies import Reading
from service.flows.fleet import fleet_overview
from service.flows.fleet_condition import fleet_condition

router = APIRouter(prefix="/fleet", tags=["fleet"])


@router.get("", responses=errors())
def read_fleet(store: Reading) -> FleetSchema:
    """How many units are in which condition."""
    return FleetSchema.model_validate(fleet_condition(store))


@router.get(
    "/report",
    responses={200: {"content": {"text/csv": {"schema": {"type": "string"}}}}, **errors(422)},
    response_model=UnitPage,
)
def report_fleet(
    store: Reading,
    format: Annotated[Literal["json", "csv"], Query(description="Form of the answer.")] = "json",
    page: Page = 1,
    limit: Annotated[int, Query(ge=1, le=10_000, description="How many units on a page.")] = 10_000,
) -> Response:
    """The condition of every unit, worst first."""
    found = fleet_overview(store, page=page, limit=limit)
    if format == "csv":
        return as_csv(fleet_table(found), "fleet.csv")
    units = [UnitSummarySchema.model_validate(unit) for unit in found]
    answer = UnitPage(units=units, page=page, limit=limit, next_page=next_page(page, limit, len(units)))
    return Response(answer.model_dump_json(), media_type="application/json")
