"""The addresses of flags: all open ones, and the forms that acknowledge or resolve one, or those that were ticked."""

from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, Form, Query, Request
from fastapi.responses import HTMLResponse, RedirectResponse
from pydantic import Field

from service.dependencies import Now, Reading, StorageOf
from service.flows.handle_flag import acknowledge_flag, bring_flags, resolve_flag
from service.pages.flags import flags_page
from service.pages.flags_view import FlagsAsked, FlagsView
from service.pages.forms import SEE_OTHER, By, Number, Why
from service.pages.render import render
from service.records.flag import Flag, FlagState

router = APIRouter(prefix="/flags", include_in_schema=False)
Chosen = Annotated[list[Annotated[int, Field(ge=1, le=2_000_000_000)]], Form(min_length=1, max_length=200)]
"""Flags that were ticked."""
MOST = 200
"""Flags on the page: as many as anybody reads through; the API lists the rest."""


@router.get("")
def show_flags(request: Request, store: Reading, asked: Annotated[FlagsAsked, Query()]) -> HTMLResponse:
    """The open flags of the fleet, newest first, or those of them that the address asks for."""
    view = FlagsView.of(asked)
    return render(request, "flags.html", flags_page(store.flags.page(view.query(MOST + 1)), view, MOST))


@router.post("/acknowledge")
def acknowledge_chosen(
    flag: Chosen, by: By, why: Why, storage: StorageOf, now: Now, *, asked: Annotated[FlagsAsked, Query()]
) -> RedirectResponse:
    """Somebody looks after several."""
    bring_flags(storage, flag, FlagState.ACKNOWLEDGED, by, why, now)
    return RedirectResponse(FlagsView.of(asked).url("/flags"), SEE_OTHER)


@router.post("/resolve")
def resolve_chosen(
    flag: Chosen, by: By, why: Why, storage: StorageOf, now: Now, *, asked: Annotated[FlagsAsked, Query()]
) -> RedirectResponse:
    """Several matters are settled."""
    bring_flags(storage, flag, FlagState.RESOLVED, by, why, now)
    return RedirectResponse(FlagsView.of(asked).url("/flags"), SEE_OTHER)


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
