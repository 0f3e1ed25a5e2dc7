"""The list of sessions, narrowed and ordered by its address, and two beside each other."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse

from service.fleet.records import FleetChoices
from service.fleet.store import Fleet
from service.pages.session.comparison import compare, comparison_page
from service.pages.session.view import STATE_CHOICES, VERDICTS, SessionsView
from service.sessions.lines import SessionLine, session_lines
from service.sessions.records import StoredSession
from service.sessions.store import Sessions
from service.web.dependencies import Reading, SettingsOf
from service.web.fields import Sought
from service.web.list_view import Shown
from service.web.render import render


@dataclass(frozen=True)
class SessionsPage:
    """Everything the list of sessions shows."""

    view: SessionsView
    shown: Shown[StoredSession]
    lines: tuple[SessionLine, ...]
    choices: FleetChoices
    """Types and stands that the list can be narrowed to."""
    states: Mapping[str, str]
    verdicts: Mapping[str, str]


def sessions_page(found: Sequence[StoredSession], view: SessionsView, choices: FleetChoices) -> SessionsPage:
    """One page of sessions."""
    shown = Shown.of(view, found, lambda session: session.id)
    return SessionsPage(
        view=view,
        shown=shown,
        lines=session_lines(shown.entries),
        choices=choices,
        states=STATE_CHOICES,
        verdicts=VERDICTS,
    )


router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)
Chosen = Annotated[Sought, Query()]


@router.get("/sessions")
def show_sessions(request: Request, store: Reading, view: Annotated[SessionsView, Query()]) -> HTMLResponse:
    """Sessions, the newest first unless another order is asked for."""
    found = Sessions(store).wanted(view.query())
    return render(request, "sessions.html", sessions_page(found, view, Fleet(store).choices()))


@router.get("/compare")
def show_comparison(request: Request, store: Reading, settings: SettingsOf, a: Chosen, b: Chosen) -> HTMLResponse:
    """Two sessions of one unit, parameter by parameter; the earlier one first, whichever was named first."""
    return render(request, "comparison.html", comparison_page(compare(store, a, b, settings.coverage_factor)))
