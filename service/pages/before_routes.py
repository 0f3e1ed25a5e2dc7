"""The addresses of what is asked before a measurement and while it is made; nothing is stored."""

from dataclasses import dataclass
from typing import Annotated, TypeVar

from fastapi import APIRouter, Depends, Request
from fastapi.responses import HTMLResponse
from pydantic import BaseModel, BeforeValidator, Field, ValidationError

from estimator.errors import Problem
from service.arriving import ArrivingOf, LandedFile
from service.dependencies import Reading, StorageOf
from service.errors import RefusedError
from service.pages.before import missing_page, ready_form, ready_page
from service.pages.render import render
from service.planning.question import blank
from service.planning.ready import ReadyQuestion
from service.records.received import SentFile
from service.views.missing import missing_of
from service.views.pattern import type_names
from service.views.readiness import readiness_of

T = TypeVar("T", bound=BaseModel)

NO_FILE = "The file did not come with the form: choose it again."

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


class Programme(BaseModel):
    """What the form of missing positions says."""

    positions: Annotated[Annotated[int, Field(ge=2, le=360)] | None, BeforeValidator(blank)] = None
    runs: Annotated[str, Field(pattern="^(both|direct)$")] = "both"


@dataclass(frozen=True)
class Brought:
    """A file, and the fields beside it."""

    file: SentFile
    fields: dict[str, str]


async def _brought(arriving: ArrivingOf) -> Brought:
    form = await arriving.form(most_files=1)
    file = form.get("file")
    if not isinstance(file, LandedFile) or not file.filename:
        raise RefusedError(NO_FILE, (Problem("file", "is missing from the form"),))
    fields = {name: value for name, value in form.items() if isinstance(value, str)}
    return Brought(SentFile(file.filename, await file.content()), fields)


BroughtOf = Annotated[Brought, Depends(_brought)]
"""What the form sent."""


@router.get("/ready")
def show_ready_form(request: Request, store: Reading) -> HTMLResponse:
    """The form."""
    return render(request, "ready.html", ready_form(ReadyQuestion.model_validate({}), type_names(store)))


@router.post("/ready")
def show_ready(request: Request, brought: BroughtOf, storage: StorageOf) -> HTMLResponse:
    """Ready, wait, or not still."""
    asked = _read(ReadyQuestion, brought)
    answer = readiness_of(storage, brought.file, asked)
    with storage.database.reading() as store:
        types = type_names(store)
    return render(request, "ready.html", ready_page(asked, types, answer))


@router.get("/missing")
def show_missing_form(request: Request) -> HTMLResponse:
    """The form."""
    return render(request, "missing.html", missing_page(None, "both"))


@router.post("/missing")
def show_missing(request: Request, brought: BroughtOf) -> HTMLResponse:
    """What is still to be measured, and how well everything is known so far."""
    asked = _read(Programme, brought)
    found = missing_of(brought.file, asked.positions, both_runs=asked.runs == "both")
    return render(request, "missing.html", missing_page(asked.positions, asked.runs, found))


def _read(kind: type[T], brought: Brought) -> T:
    """The fields; RefusedError that names each that cannot be used."""
    try:
        return kind.model_validate({name: value.strip() for name, value in brought.fields.items()})
    except ValidationError as fault:
        problems = tuple(Problem(".".join(map(str, one["loc"])), one["msg"]) for one in fault.errors())
        raise RefusedError("The form cannot be used.", problems) from fault
