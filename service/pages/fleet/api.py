"""The fleet as a whole."""

from collections.abc import Sequence
from datetime import datetime
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response

from service.fleet.condition import FleetCondition
from service.fleet.records import FleetQuery
from service.fleet.store import Fleet
from service.kit.libraries import pl
from service.languages.language import asked
from service.pages.unit.schemas import UnitInUse, UnitPage, units_in_use
from service.papers.fleet.paper import fleet_pdf
from service.papers.fleet.report import fleet_report
from service.papers.fleet.workbook import fleet_xlsx
from service.web.dependencies import Now, Reading
from service.web.fields import Page, Window
from service.web.files import BINARY, BY_HEADER, FORMS, PDF, TABLES, XLSX, as_file, as_table, table_of, wanted_form
from service.web.problem_document import errors
from service.work.dependencies import ReadingFleet

FLEET_COLUMNS = {
    "serial": str, "unit_type": str, "simulated": bool, "sessions": int,
    "last_session": str, "last_at": datetime, "verdict": str, "is_reference": bool,
    "reason": str,
    "worst_sensor": str, "worst_parameter": str, "margin": float,
    "diagnosis": str, "flags": int, "due": datetime, "lot": str,
    "said": str, "usable": bool, "use": str, "last_at_ms": int, "due_ms": int,
}  # fmt: skip


def fleet_table(units: Sequence[UnitInUse]) -> "pl.DataFrame":
    """One row a unit."""
    return table_of([_unit_row(unit) for unit in units], FLEET_COLUMNS)


def _unit_row(unit: UnitInUse) -> dict[str, Any]:
    return vars(unit) | {"last_at_ms": unit.last_at_ms, "due_ms": unit.due_ms}


router = APIRouter(prefix="/fleet", tags=["fleet"])
FORM = (
    "Form of the answer; a workbook and a paper are of the whole fleet, whatever the page. Without it the header "
    "`Accept` chooses, else it is JSON."
)
REPORTS = {**FORMS, XLSX: "xlsx", PDF: "pdf"}
"""Forms of reports: tables, and those of the whole fleet."""


@router.get("", responses=errors())
def read_fleet(store: Reading) -> FleetCondition:
    """The number of units in each condition."""
    return Fleet(store).condition()


@router.get(
    "/report",
    responses={200: {"content": {**TABLES, XLSX: BINARY, PDF: BINARY}}, **errors(422)},
    response_model=UnitPage,
)
def report_fleet(
    request: Request,
    store: ReadingFleet,
    now: Now,
    format: Annotated[Literal["json", "csv", "parquet", "arrow", "xlsx", "pdf"] | None, Query(description=FORM)] = None,
    page: Page = 1,
    limit: Annotated[int, Query(ge=1, le=10_000, description="How many units on a page.")] = 10_000,
) -> Response:
    """The condition of every unit, worst first."""
    form = wanted_form(request, format, REPORTS)
    if form == "xlsx":
        return as_file(fleet_xlsx(store, fleet_report(store, now), asked(request.scope)), XLSX, "fleet.xlsx")
    if form == "pdf":
        return as_file(fleet_pdf(store, fleet_report(store, now), asked(request.scope)), PDF, "fleet.pdf")
    window = Window(page, limit)
    found = units_in_use(store, Fleet(store).units(FleetQuery(offset=window.offset, limit=limit)), now)
    if form != "json":
        return as_table(fleet_table(found), form, "fleet")
    answer = UnitPage(units=found, **window.place(len(found)))
    return Response(answer.model_dump_json(), media_type="application/json", headers=BY_HEADER)
