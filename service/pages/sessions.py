"""The list of sessions, narrowed and ordered by its address."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from service.pages.saved import Saved
from service.pages.session_lines import SessionLine, session_lines
from service.pages.sessions_view import ORDERS, PAGE_SIZE, STATE_CHOICES, VERDICTS, SessionsView
from service.records.fleet import FleetChoices
from service.records.session import StoredSession


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
