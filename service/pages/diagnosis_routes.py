"""The addresses of diagnoses: the page, and the forms that accept a cause or compute a unit's sessions again."""

from typing import Annotated

from fastapi import APIRouter, Form, Path, Request
from fastapi.responses import HTMLResponse, RedirectResponse

from service.background.read_diagnosis import GLANCE
from service.dependencies import Now, ReaderOf, Reading, StorageOf
from service.flows.accept_model import accept_model
from service.flows.withdraw_model import withdraw_model
from service.pages.diagnosis import diagnosis_page
from service.pages.forms import NO_NUL, SEE_OTHER, By, Key
from service.pages.render import render
from service.records.model import NewModel, Scope
from service.views.diagnosis_report import diagnosis_report

router = APIRouter(include_in_schema=False)


@router.get("/sessions/{id}/diagnosis")
def show_diagnosis(request: Request, store: Reading, id: Key, reader: ReaderOf) -> HTMLResponse:
    """What the simulation gets wrong about the session."""
    page = diagnosis_page(diagnosis_report(store, id, reader.read(id, patience=GLANCE)))
    return render(request, "diagnosis.html", page)


@router.post("/sessions/{id}/diagnosis/accept")
def accept(
    id: Key,
    storage: StorageOf,
    reader: ReaderOf,
    now: Now,
    *,
    cause: Annotated[str, Form(max_length=200, pattern=NO_NUL)],
    scope: Annotated[Scope, Form()],
    by: By,
    note: Annotated[str, Form(max_length=2000, pattern=NO_NUL)] = "",
) -> RedirectResponse:
    """Accepts a named cause, and shows the models that concern the session."""
    accept_model(storage, reader.made(id), NewModel(cause, scope, by, note), now)
    return RedirectResponse(f"/sessions/{id}/diagnosis#models", SEE_OTHER)


@router.post("/sessions/{id}/diagnosis/withdraw/{revision}")
def withdraw(
    id: Key,
    revision: Annotated[int, Path(ge=1, le=2**31 - 1)],
    storage: StorageOf,
    now: Now,
    *,
    by: By,
    why: Annotated[str, Form(min_length=1, max_length=2000, pattern=NO_NUL)],
) -> RedirectResponse:
    """Takes an accepted cause out of the model again, and shows the models that concern the session."""
    withdraw_model(storage, revision, by, why, now)
    return RedirectResponse(f"/sessions/{id}/diagnosis#models", SEE_OTHER)
