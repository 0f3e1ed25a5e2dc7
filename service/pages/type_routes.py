"""The addresses of unit types: the list, and one of them."""

from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, Depends, Form, Request
from fastapi.responses import HTMLResponse, RedirectResponse

from service.dependencies import Now, Reading, SettingsOf, StorageOf
from service.flows.set_tolerances import set_tolerances
from service.pages.forms import SEE_OTHER, By, Key, Why
from service.pages.group import group_section
from service.pages.render import render
from service.pages.tolerance_form import wanted
from service.pages.tolerance_preview import preview_page
from service.pages.unit_types import type_page, types_page
from service.records.group import Level
from service.records.tolerance_preview import WantedTolerances
from service.views.tolerance_preview import preview_tolerances
from service.views.type_report import every_type, type_report

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.get("/unit-types")
def show_types(request: Request, store: Reading) -> HTMLResponse:
    """Every unit type with its tolerances and how its units are."""
    return render(request, "unit_types.html", types_page(every_type(store)))


async def _form(request: Request) -> dict[str, str]:
    """The numbers of the form, as they were written."""
    return {key: value for key, value in (await request.form()).items() if isinstance(value, str)}


@router.post("/unit-types/{name:path}/tolerances")
def set_limits(
    name: Key,
    by: By,
    why: Why,
    seen: Annotated[int, Form(ge=1, le=2_000_000_000)],
    form: Annotated[dict[str, str], Depends(_form)],
    *,
    storage: StorageOf,
    now: Now,
) -> RedirectResponse:
    """Other tolerances from the next session on, and another longest interval at once."""
    with storage.database.reading() as store:
        asked = wanted(store.unit_types.get(name), form)
    limits, days = (asked.tolerances, asked.gyro_tolerances), asked.interval_days
    set_tolerances(storage, name, *limits, now, interval_days=days, who=by, why=why, seen=seen)
    return RedirectResponse(f"/unit-types/{quote(name)}#tolerances", SEE_OTHER)


@router.post("/unit-types/{name:path}/tolerances/preview")
def preview_limits(
    request: Request, name: Key, form: Annotated[dict[str, str], Depends(_form)], store: Reading, settings: SettingsOf
) -> HTMLResponse:
    """What other tolerances would change; nothing is stored."""
    known = store.unit_types.get(name)
    asked = wanted(known, form)
    found = preview_tolerances(
        store, name, WantedTolerances(asked.tolerances, asked.gyro_tolerances), settings.coverage_factor
    )
    return render(request, "tolerance_preview.html", preview_page(known, asked, form, found))


@router.get("/unit-types/{name:path}")
def show_type(request: Request, store: Reading, now: Now, name: Key) -> HTMLResponse:
    """One unit type: what is allowed and who allowed it, the nominal model, its units."""
    return render(
        request, "unit_type.html", type_page(type_report(store, name), now, group_section(store, Level.TYPE, name))
    )
