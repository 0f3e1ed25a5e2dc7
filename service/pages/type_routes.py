"""The addresses of unit types: the list, and one of them."""

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse

from service.dependencies import Now, Reading
from service.pages.forms import Key
from service.pages.group import group_section
from service.pages.render import render
from service.pages.unit_types import type_page, types_page
from service.records.group import Level
from service.views.type_report import every_type, type_report

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.get("/unit-types")
def show_types(request: Request, store: Reading) -> HTMLResponse:
    """Every unit type with its tolerances and how its units are."""
    return render(request, "unit_types.html", types_page(every_type(store)))


@router.get("/unit-types/{name:path}")
def show_type(request: Request, store: Reading, now: Now, name: Key) -> HTMLResponse:
    """One unit type: what is allowed and who allowed it, the nominal model, its units."""
    return render(
        request, "unit_type.html", type_page(type_report(store, name), now, group_section(store, Level.TYPE, name))
    )
