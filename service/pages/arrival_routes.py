"""The addresses of what became of uploads: the list, and one that was refused."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse

from service.dependencies import Reading
from service.pages.arrivals import ArrivalsAsked, arrivals_page, arrivals_query, refusal_page
from service.pages.forms import Number
from service.pages.render import render

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.get("/uploads")
def show_uploads(request: Request, store: Reading, asked: Annotated[ArrivalsAsked, Query()]) -> HTMLResponse:
    """Every file that came in, newest first, and what became of it."""
    query = arrivals_query(asked)
    jobs = () if asked.after or query.refused else store.jobs.open_uploads(query.text)
    return render(request, "arrivals.html", arrivals_page(store.arrivals.page(query), asked, jobs))


@router.get("/uploads/{id}")
def show_refusal(request: Request, store: Reading, id: Number) -> HTMLResponse:
    """A file that was refused, with every problem."""
    return render(request, "refusal.html", refusal_page(store.arrivals.refusal(id)))
