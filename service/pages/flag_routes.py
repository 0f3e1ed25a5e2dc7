"""The addresses of flags: all open ones, and the forms that acknowledge or resolve one and lead back to its unit."""

from urllib.parse import quote

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse, RedirectResponse

from service.dependencies import Now, Reading, StorageOf
from service.flows.handle_flag import acknowledge_flag, resolve_flag
from service.pages.flags import flags_page
from service.pages.forms import SEE_OTHER, By, Number, Why
from service.pages.render import render
from service.records.flag import Flag, FlagState
from service.storage.queries.flags import FlagQuery

router = APIRouter(prefix="/flags", include_in_schema=False)
MOST = 200
"""Flags on the page: as many as anybody reads through; the API lists the rest."""


@router.get("")
def show_flags(request: Request, store: Reading) -> HTMLResponse:
    """Every open flag of the fleet, newest first."""
    found = store.flags.page(FlagQuery(limit=MOST + 1))
    opened = tuple(flag for flag in found if flag.state is not FlagState.RESOLVED)
    return render(request, "flags.html", flags_page(opened, MOST))


@router.post("/{id}/acknowledge")
def acknowledge(id: Number, by: By, why: Why, storage: StorageOf, now: Now) -> RedirectResponse:
    """Somebody looks after the flag."""
    return _back(acknowledge_flag(storage, id, by, why, now))


@router.post("/{id}/resolve")
def resolve(id: Number, by: By, why: Why, storage: StorageOf, now: Now) -> RedirectResponse:
    """The matter is settled."""
    return _back(resolve_flag(storage, id, by, why, now))


def _back(flag: Flag) -> RedirectResponse:
    return RedirectResponse(f"/units/{quote(flag.unit)}#flags", SEE_OTHER)
