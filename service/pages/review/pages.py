"""The page of what waits for a person."""

from dataclasses import dataclass

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse

from service.pages.review.queue import Waiting, WaitingKind, waiting_for
from service.people.admission import PersonOf
from service.web.dependencies import Now, Reading
from service.web.render import render

HEADINGS = {
    WaitingKind.MINE: "Assigned to me",
    WaitingKind.OVERDUE: "Overdue",
    WaitingKind.SESSION: "Questioned sessions",
    WaitingKind.CERTIFICATE: "Certificates to sign",
    WaitingKind.FLAG: "Flags without an assignee",
    WaitingKind.WORK: "Failed work",
}


@dataclass(frozen=True)
class ReviewPage:
    """What waits, by kind."""

    sections: tuple[tuple[WaitingKind, str, tuple[Waiting, ...]], ...]
    """Kind, heading and entries; none without an entry."""


def review_page(waiting: tuple[Waiting, ...]) -> ReviewPage:
    """In the order of the headings."""
    by_kind = {kind: tuple(one for one in waiting if one.kind is kind) for kind in HEADINGS}
    return ReviewPage(tuple((kind, HEADINGS[kind], own) for kind, own in by_kind.items() if own))


router = APIRouter(include_in_schema=False)


@router.get("/review")
def show_review(request: Request, store: Reading, person: PersonOf, now: Now) -> HTMLResponse:
    """What waits for whoever looks, by role."""
    return render(request, "review.html", review_page(waiting_for(store, person, now)))
