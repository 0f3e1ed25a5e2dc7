"""The pages of uploads and their outcomes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse
from pydantic import BaseModel

from estimator.message import say_count
from service.jobs.records import Job
from service.jobs.store import Jobs
from service.kit.measures import size_in_words
from service.people.dependencies import Number
from service.sessions.words.conditions import Condition, condition_of, said_with
from service.uploads.records import Arrival, ArrivalQuery, Refusal, refusal_number
from service.uploads.store import Arrivals
from service.web.dependencies import Reading
from service.web.fields import Sought
from service.web.list_view import address_of
from service.web.render import render
from service.work.pages import JobLine, job_line

PAGE_SIZE = 20
"""Uploads on a page: three screens at most."""
REFUSED = "refused"
PATH = "/uploads"


class ArrivalsQuery(BaseModel):
    """Query parameters."""

    q: Sought = ""
    only: Sought = ""
    after: Sought = ""
    """Identifier of a session, or number of a refusal after ``r``."""


@dataclass(frozen=True)
class ArrivalRow:
    """One upload."""

    arrival: Arrival
    filename: str
    size: str
    condition: Condition | None
    """Condition of the session; None for a refused file."""
    said: str
    """Outcome of the upload."""


@dataclass(frozen=True)
class ArrivalsPage:
    """Contents of the list of uploads."""

    text: str
    refused: bool
    rows: tuple[ArrivalRow, ...]
    later: str
    """Address of the next page; empty on the last."""
    narrows: bool
    jobs: tuple[JobLine, ...]
    """Large files that are being read."""


@dataclass(frozen=True)
class RefusalPage:
    """Contents of the page of a refused upload."""

    refusal: Refusal
    size: str


def arrivals_query(parameters: ArrivalsQuery) -> ArrivalQuery:
    """The query of the store: one upload more than fit on the page."""
    refusal = refusal_number(parameters.after)
    return ArrivalQuery(
        text=parameters.q.strip() or None,
        refused=parameters.only == REFUSED,
        after_session=parameters.after or None if refusal is None else None,
        after_refusal=refusal,
        limit=PAGE_SIZE + 1,
    )


def arrivals_page(arrivals: Sequence[Arrival], parameters: ArrivalsQuery, jobs: Sequence[Job] = ()) -> ArrivalsPage:
    """One page of uploads."""
    shown, text, only = arrivals[:PAGE_SIZE], parameters.q.strip(), REFUSED if parameters.only == REFUSED else ""
    after = {"q": text, "only": only, "after": shown[-1].name} if len(arrivals) > PAGE_SIZE else {}
    return ArrivalsPage(
        text=text,
        refused=bool(only),
        rows=tuple(map(_row, shown)),
        later=address_of(PATH, after) if after else "",
        narrows=bool(text or only or parameters.after),
        jobs=tuple(map(job_line, jobs)),
    )


def refusal_page(refusal: Refusal) -> RefusalPage:
    """The page of one refused upload."""
    return RefusalPage(refusal, size_in_words(refusal.size))


def _row(arrival: Arrival) -> ArrivalRow:
    session, refusal = arrival.session, arrival.refusal
    if refusal is not None:
        count = len(refusal.problems)
        outcome = say_count("{n} problem: nothing was stored", "{n} problems: nothing was stored", count)
        return ArrivalRow(arrival, refusal.filename, size_in_words(refusal.size), None, outcome)
    assert session is not None, "an arrival is one of the two"
    condition = said_with(condition_of(session.verdict, is_reference=session.is_reference), session.reservations)
    return ArrivalRow(arrival, session.filename, size_in_words(session.size), condition, session.reason)


router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.get("/uploads")
def show_uploads(request: Request, store: Reading, asked: Annotated[ArrivalsQuery, Query()]) -> HTMLResponse:
    """All received files, newest first, with their result."""
    query = arrivals_query(asked)
    jobs = () if asked.after or query.refused else Jobs(store).open_uploads(query.text)
    return render(request, "arrivals.html", arrivals_page(Arrivals(store).page(query), asked, jobs))


@router.get("/uploads/{id}")
def show_refusal(request: Request, store: Reading, id: Number) -> HTMLResponse:
    """A file that was refused, with every problem."""
    return render(request, "refusal.html", refusal_page(Arrivals(store).refusal(id)))
