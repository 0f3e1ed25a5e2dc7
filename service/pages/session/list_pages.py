"""The list of sessions, narrowed and ordered by its address, and two beside each other."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse

from service.fleet.records import FleetChoices
from service.fleet.store import Fleet
from service.pages.saved import Saved, saved
from service.pages.session.comparison import compare, comparison_page
from service.pages.session.view import ORDERS, PAGE_SIZE, STATE_CHOICES, VERDICTS, SessionsAsked, SessionsView
from service.people.admission import PersonOf
from service.people.view_store import SavedViews
from service.people.views import ListPage
from service.sessions.lines import SessionLine, session_lines
from service.sessions.records import StoredSession
from service.sessions.store import Sessions
from service.web.dependencies import Reading, SettingsOf
from service.web.fields import NO_NUL
from service.web.render import render


@dataclass(frozen=True)
class SessionsPage:
    """Everything the list of sessions shows."""

    view: SessionsView
    lines: tuple[SessionLine, ...]
    earlier: str
    """Address of the page before this one; empty where it is the first."""
    later: str
    """Address of the next page; empty where it is the last."""
    choices: FleetChoices
    """Types and stands that the list can be narrowed to."""
    states: Mapping[str, str]
    verdicts: Mapping[str, str]
    orders: Mapping[str, str]
    saved: Saved
    """Views of the list that were kept."""


def sessions_page(
    found: Sequence[StoredSession], view: SessionsView, choices: FleetChoices, kept: Saved
) -> SessionsPage:
    """One page of sessions; one more than fit on it says that there are others in the direction of reading."""
    backwards, others = bool(view.before), len(found) > PAGE_SIZE
    shown = found[-PAGE_SIZE:] if backwards else found[:PAGE_SIZE]
    is_first, is_last = (not others, False) if backwards else (not view.after, not others)
    return SessionsPage(
        view=view,
        lines=session_lines(shown),
        earlier="" if is_first or not shown else view.url(before=shown[0].id, after=""),
        later="" if is_last or not shown else view.url(after=shown[-1].id, before=""),
        choices=choices,
        states=STATE_CHOICES,
        verdicts=VERDICTS,
        orders=ORDERS,
        saved=kept,
    )


router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)
Chosen = Annotated[str, Query(max_length=200, pattern=NO_NUL)]


@router.get("/sessions")
def show_sessions(
    request: Request, store: Reading, person: PersonOf, asked: Annotated[SessionsAsked, Query()]
) -> HTMLResponse:
    """Sessions, the newest first unless another order is asked for."""
    view = SessionsView.of(asked)
    found = Sessions(store).wanted(view.query())
    kept = saved(SavedViews(store).of(person.login, ListPage.SESSIONS), view, ListPage.SESSIONS, person)
    return render(request, "sessions.html", sessions_page(found, view, Fleet(store).choices(), kept))


@router.get("/compare")
def show_comparison(request: Request, store: Reading, settings: SettingsOf, a: Chosen, b: Chosen) -> HTMLResponse:
    """Two sessions of one unit, parameter by parameter; the earlier one first, whichever was named first."""
    return render(request, "comparison.html", comparison_page(compare(store, a, b, settings.coverage_factor)))
