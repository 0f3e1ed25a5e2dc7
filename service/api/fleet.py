"""The fleet as a whole."""

from typing import Annotated, Literal

from fastapi import APIRouter, Query, Response

from service.api.exports import as_csv, as_file, fleet_table
from service.api.schemas.fields import Page, Window
from service.api.schemas.problem import errors
from service.api.schemas.units import FleetSchema, UnitPage, UnitSummarySchema
from service.dependencies import Now, Reading
from service.records.fleet import FleetQuery
from service.reports.fleet_paper import fleet_pdf
from service.reports.fleet_workbook import fleet_xlsx
from service.views.fleet_report import fleet_report

router = APIRouter(prefix="/fleet", tags=["fleet"])
PDF = "application/pdf"
"""Media type."""
XLSX = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"
"""Media type (ISO/IEC 29500)."""
BYTES = {"schema": {"type": "string", "format": "binary"}}
"""How OpenAPI describes a file."""


@router.get("", responses=errors())
def read_fleet(store: Reading) -> FleetSchema:
    """How many units are in which condition."""
    return FleetSchema.model_validate(store.fleet.condition())


@router.get(
    "/report",
    responses={200: {"content": {"text/csv": {"schema": {"type": "string"}}, XLSX: BYTES, PDF: BYTES}}, **errors(422)},
    response_model=UnitPage,
)
def report_fleet(
    store: Reading,
    now: Now,
    format: Annotated[
        Literal["json", "csv", "xlsx", "pdf"],
        Query(description="Form of the answer; a workbook and a paper are of the whole fleet, whatever the page."),
    ] = "json",
    page: Page = 1,
    limit: Annotated[int, Query(ge=1, le=10_000, description="How many units on a page.")] = 10_000,
) -> Response:
    """The condition of every unit, worst first."""
    if format == "xlsx":
        return as_file(fleet_xlsx(store, fleet_report(store, now)), XLSX, "fleet.xlsx")
    if format == "pdf":
        return as_file(fleet_pdf(store, fleet_report(store, now)), PDF, "fleet.pdf")
    window = Window(page, limit)
    found = store.fleet.units(FleetQuery(offset=window.offset, limit=limit))
    if format == "csv":
        return as_csv(fleet_table(found), "fleet.csv")
    units = [UnitSummarySchema.model_validate(unit) for unit in found]
    answer = UnitPage(units=units, page=page, limit=limit, next_page=window.next_after(len(units)))
    return Response(answer.model_dump_json(), media_type="application/json")
