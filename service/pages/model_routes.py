"""The addresses of accepted causes: the page of one, and the forms that accept what a group shows and withdraw it."""

from typing import Annotated

from fastapi import APIRouter, Form, Request
from fastapi.responses import HTMLResponse, RedirectResponse

from service.dependencies import Now, Reading, ReceptionOf
from service.flows.accept_lasting import accept_lasting
from service.flows.recompute import recompute_beside
from service.flows.withdraw_model import withdraw_model
from service.pages.forms import NO_NUL, SEE_OTHER, By, Number, Why
from service.pages.model import model_page
from service.pages.render import render
from service.records.group import Level
from service.records.model import NewLasting

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)
Plain = Annotated[str, Form(max_length=200, pattern=NO_NUL)]


@router.get("/models/{id}")
def show_model(request: Request, store: Reading, id: Number) -> HTMLResponse:
    """An accepted cause, how far its sessions are computed again, and what moved."""
    revision = store.models.get(id)
    of_subject = store.models.of_subject(revision.scope, revision.subject)
    return render(request, "model.html", model_page(revision, of_subject, store.recomputations.of(id)))


@router.post("/groups/accept")
def accept(
    reception: ReceptionOf,
    now: Now,
    *,
    level: Annotated[Level, Form()],
    name: Plain,
    cause: Plain,
    sensors: Annotated[list[str], Form(default_factory=list, max_length=1000)],
    by: By,
    note: Annotated[str, Form(max_length=2000, pattern=NO_NUL)] = "",
) -> RedirectResponse:
    """Accepts what a group of sessions shows, and shows what that moves."""
    with reception.storage.database.reading() as store:
        group = store.groups.find(level, name)
    made = accept_lasting(reception.storage, group, NewLasting(cause, tuple(sensors), by, note), now)
    recompute_beside(reception, now)
    return RedirectResponse(f"/models/{made.id}", SEE_OTHER)


@router.post("/models/{id}/withdraw")
def withdraw(id: Number, reception: ReceptionOf, now: Now, *, by: By, why: Why) -> RedirectResponse:
    """Takes an accepted cause out of the model again, and shows what that moves."""
    made = withdraw_model(reception.storage, id, by, why, now)
    recompute_beside(reception, now)
    return RedirectResponse(f"/models/{made.id}", SEE_OTHER)
