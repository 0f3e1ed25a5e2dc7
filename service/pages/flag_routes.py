"""The addresses of flags: all open ones, and the forms that acknowledge or resolve one, or those that were ticked."""

from dataclasses import replace
from typing import Annotated

from fastapi import APIRouter, Form, Query, Request
from fastapi.responses import HTMLResponse, RedirectResponse
from pydantic import Field

from service.admission import PersonOf
from service.dependencies import Now, Reading, StorageOf
from service.flows.assign_flags import Assignment, assign_flag, assign_flags
from service.flows.handle_flag import acknowledge_flag, bring_flags, resolve_flag
from service.pages.flags import flag_cards, flags_page
from service.pages.flags_view import FlagsAsked, FlagsView, choices_of
from service.pages.forms import NO_NUL, SEE_OTHER, By, Number, Perhaps, Why
from service.pages.render import render
from service.pages.saved import saved
from service.records.flag import Flag, FlagState
from service.records.saved_view import ListPage
from service.views.assigned import ME, active_names, assignee_meant

router = APIRouter(prefix="/flags", include_in_schema=False)
Chosen = Annotated[list[Annotated[int, Field(ge=1, le=2_000_000_000)]], Form(min_length=1, max_length=200)]
"""Flags that were ticked."""
Asking = Annotated[FlagsAsked, Query()]
"""The view that a form was sent from, and that comes back."""
To = Annotated[str, Form(max_length=200, pattern=NO_NUL)]
"""Login or name; empty for nobody."""


@router.get("")
def show_flags(request: Request, store: Reading, person: PersonOf, asked: Asking) -> HTMLResponse:
    """The open flags of the fleet, newest first, or those of them that the address asks for."""
    view = FlagsView.of(asked)
    if view.assigned == ME and not person.login:
        view = replace(view, assigned="")
    found = store.flags.page(view.query(assignee_meant(store, view.assigned, person)))
    kept = saved(store.saved_views.of(person.login, ListPage.FLAGS), view, ListPage.FLAGS, person)
    assigned = choices_of(store.flags.assignees(), is_signed_in=bool(person.login))
    return render(request, "flags.html", flags_page(found, view, assigned, active_names(store), kept))


@router.post("/assign")
def assign_chosen(
    flag: Chosen, by: By, storage: StorageOf, now: Now, *, to: To = "", why: Perhaps = "", asked: Asking
) -> RedirectResponse:
    """Several are given to somebody."""
    assign_flags(storage, flag, Assignment(to, by, why), now)
    return RedirectResponse(FlagsView.of(asked).url(), SEE_OTHER)


@router.post("/{id}/assign")
def assign(id: Number, by: By, storage: StorageOf, now: Now, *, to: To = "", why: Perhaps = "") -> RedirectResponse:
    """One is given to somebody."""
    return _back(assign_flag(storage, id, Assignment(to, by, why), now))


@router.post("/acknowledge")
def acknowledge_chosen(
    flag: Chosen, by: By, why: Why, storage: StorageOf, now: Now, *, to: To = "", asked: Asking
) -> RedirectResponse:
    """Somebody looks after several; where the form names whom, they are given to them."""
    if to.strip():
        assign_flags(storage, flag, Assignment(to, by), now)
    bring_flags(storage, flag, FlagState.ACKNOWLEDGED, by, why, now)
    return RedirectResponse(FlagsView.of(asked).url(), SEE_OTHER)


@router.post("/resolve")
def resolve_chosen(flag: Chosen, by: By, why: Why, storage: StorageOf, now: Now, *, asked: Asking) -> RedirectResponse:
    """Several matters are settled."""
    bring_flags(storage, flag, FlagState.RESOLVED, by, why, now)
    return RedirectResponse(FlagsView.of(asked).url(), SEE_OTHER)


@router.post("/{id}/acknowledge")
def acknowledge(id: Number, by: By, why: Why, storage: StorageOf, now: Now) -> RedirectResponse:
    """Somebody looks after the flag."""
    return _back(acknowledge_flag(storage, id, by, why, now))


@router.post("/{id}/resolve")
def resolve(id: Number, by: By, why: Why, storage: StorageOf, now: Now) -> RedirectResponse:
    """The matter is settled."""
    return _back(resolve_flag(storage, id, by, why, now))


def _back(flag: Flag) -> RedirectResponse:
    (card,) = flag_cards([flag])
    return RedirectResponse(f"{card.home}#flags", SEE_OTHER)
