"""The addresses of several sessions: the list, and two of them beside each other."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse

from service.admission import PersonOf
from service.dependencies import Reading, SettingsOf
from service.pages.comparison import comparison_page
from service.pages.forms import NO_NUL
from service.pages.render import render
from service.pages.saved import saved
from service.pages.sessions import sessions_page
from service.pages.sessions_view import SessionsAsked, SessionsView
from service.records.saved_view import ListPage
from service.views.comparison import compare

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)
Chosen = Annotated[str, Query(max_length=200, pattern=NO_NUL)]


@router.get("/sessions")
def show_sessions(
    request: Request, store: Reading, person: PersonOf, asked: Annotated[SessionsAsked, Query()]
) -> HTMLResponse:
    """Sessions, the newest first unless another order is asked for."""
    view = SessionsView.of(asked)
    found = store.sessions.wanted(view.query())
    kept = saved(store.saved_views.of(person.login, ListPage.SESSIONS), view, ListPage.SESSIONS, person)
    return render(request, "sessions.html", sessions_page(found, view, store.fleet.choices(), kept))


@router.get("/compare")
def show_comparison(request: Request, store: Reading, settings: SettingsOf, a: Chosen, b: Chosen) -> HTMLResponse:
    """Two sessions of one unit, parameter by parameter; the earlier one first, whichever was named first."""
    return render(request, "comparison.html", comparison_page(compare(store, a, b, settings.coverage_factor)))
