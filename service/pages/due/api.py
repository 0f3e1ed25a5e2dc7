"""The due list over HTTP, as JSON, CSV and XLSX."""

import io
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response
from pydantic import BaseModel, Field

from service.fleet.records import FleetQuery
from service.fleet.store import Fleet
from service.judging.usable_reading import usable_of
from service.languages.catalogue import said_in
from service.languages.language import Language, asked
from service.pages.due.board import DueCount, DueLine, due_counts, due_lines
from service.pages.due.view import MONTH, OVERDUE, UNKNOWN, DueView
from service.papers.sheets import CellKind, Column, Workbook
from service.storage.queries import Store
from service.web.dependencies import Now
from service.web.fields import Sought
from service.web.files import BINARY, BY_HEADER, XLSX, as_file, as_table, table_of, wanted_form
from service.web.problem_document import errors
from service.work.dependencies import ReadingFleet

MOST_UNITS = 10_000
"""Units of one answer."""
FORMS = {"application/json": "json", "text/csv": "csv", XLSX: "xlsx"}
COLUMNS = {
    "unit": str, "unit_type": str, "location": str, "custodian": str,
    "owner": str, "due_on": str, "days": int, "condition": str, "usable": bool,
    "use": str, "why": str,
}  # fmt: skip
SHEET = (
    Column("Unit", width=16, is_named=True), Column("Type", width=22, is_named=True),
    Column("Location", width=20, is_named=True), Column("Custodian", width=20, is_named=True),
    Column("Owner", width=20, is_named=True), Column("Next calibration due", CellKind.DATE, 13),
    Column("Days left", CellKind.NUMBER, 9), Column("Condition", CellKind.VERDICT, 24),
    Column("May it be used", width=40), Column("Why due then", width=60),
)  # fmt: skip
PERIOD = f"^({OVERDUE}|{UNKNOWN}|{MONTH.pattern})$"


class DueList(BaseModel):
    """Units by due date."""

    counts: tuple[DueCount, ...] = Field(description="How many units are due in each period, whatever `when` asks for.")
    units: tuple[DueLine, ...] = Field(description="The first to come first; 10,000 at most.")


router = APIRouter(prefix="/fleet", tags=["fleet"])


@router.get(
    "/due", responses={200: {"content": {"text/csv": BINARY, XLSX: BINARY}}, **errors(422)}, response_model=DueList
)
def read_due(
    request: Request,
    store: ReadingFleet,
    now: Now,
    when: Annotated[
        Sought | None, Query(pattern=PERIOD, description="Only `overdue`, `unknown`, or a month; else all with a date.")
    ] = None,
    location: Annotated[Sought | None, Query(description="Only those at this location.")] = None,
    custodian: Annotated[Sought | None, Query(description="Only those that this custodian has.")] = None,
    format: Annotated[
        Literal["json", "csv", "xlsx"] | None,
        Query(description="Form of the answer; without it the header `Accept` chooses, else it is JSON."),
    ] = None,
) -> Response:
    """Units by the date of their next calibration, as the calendar of due dates has them, with where they are."""
    view = DueView(when=when or "", location=location or "", custodian=custodian or "")
    found = _due(store, view, now)
    form = wanted_form(request, format, FORMS)
    if form == "xlsx":
        return as_file(_workbook(found.units, now, asked(request.scope)), XLSX, "due.xlsx")
    if form == "csv":
        return as_table(table_of([_row(line) for line in found.units], COLUMNS), form, "due")
    language = asked(request.scope)
    found = DueList(counts=found.counts, units=tuple(said_in(line, language) for line in found.units))
    return Response(found.model_dump_json(), media_type="application/json", headers=BY_HEADER)


def _due(store: Store, view: DueView, now: datetime) -> DueList:
    fleet = Fleet(store)
    dates = fleet.dates(FleetQuery(location=view.location or None, custodian=view.custodian or None))
    units = fleet.units(replace(view.query(now), limit=MOST_UNITS))
    return DueList(counts=due_counts(dates, now), units=due_lines(units, usable_of(store, units, now)))


def _row(line: DueLine) -> dict[str, Any]:
    return vars(line) | {"due_on": "" if line.due is None else f"{line.due:%Y-%m-%d}"}


def _workbook(lines: Sequence[DueLine], now: datetime, language: Language) -> bytes:
    target = io.BytesIO()
    book = Workbook(target, now, "Due list", language)
    rows = (
        (line.unit, line.unit_type, line.location or None, line.custodian or None, line.owner or None, line.due,
         line.days, line.condition, line.use, line.why)
        for line in lines
    )  # fmt: skip
    book.table("Due list", SHEET, rows)
    book.close()
    return target.getvalue()
