"""The page of the due list."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse

from estimator.message import say
from estimator.wording import counted
from service.fleet.condition import UnitSummary
from service.fleet.records import FleetChoices, FleetQuery
from service.fleet.store import Fleet
from service.judging.usable_reading import usable_of
from service.pages.due.board import DueLine, due_counts, due_lines, period_in_words
from service.pages.due.view import DueView
from service.web.dependencies import Now
from service.web.list_view import Shown, address_of
from service.web.render import render
from service.work.dependencies import ReadingFleet


@dataclass(frozen=True)
class DuePage:
    """Everything the page shows."""

    view: DueView
    periods: Mapping[str, str]
    """Periods that can be chosen, each with its number of units, in words."""
    lines: tuple[DueLine, ...]
    shown: Shown[UnitSummary]
    choices: FleetChoices
    exports: Mapping[str, str]
    """Addresses of the same as a file, by its form."""


router = APIRouter(include_in_schema=False)


@router.get("/due", response_class=HTMLResponse)
def show_due(request: Request, store: ReadingFleet, now: Now, view: Annotated[DueView, Query()]) -> HTMLResponse:
    """Units by the date of their next calibration, the first to come first."""
    fleet = Fleet(store)
    dates = fleet.dates(FleetQuery(location=view.location or None, custodian=view.custodian or None))
    units = fleet.units(view.query(now))
    shown = Shown.of(view, units, lambda unit: unit.serial)
    periods = {
        period.when: say("{period}: {units}", period=period_in_words(period.when), units=counted(period.units, "unit"))
        for period in due_counts(dates, now)
        if period.units or period.when == view.when
    }
    asked = {"when": view.when, "location": view.location, "custodian": view.custodian}
    exports = {form: address_of("/api/v1/fleet/due", asked | {"format": form}) for form in ("xlsx", "csv")}
    page = DuePage(
        view=view,
        periods=periods,
        lines=due_lines(shown.entries, usable_of(store, shown.entries, now)),
        shown=shown,
        choices=fleet.choices(),
        exports=exports,
    )
    return render(request, "due.html", page)
