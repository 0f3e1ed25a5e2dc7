"""The page of what waits for a person."""

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse

from service.pages.review.queue import WaitingKind, waiting_for
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


router = APIRouter(include_in_schema=False)


@router.get("/review")
def show_review(request: Request, store: Reading, person: PersonOf, now: Now) -> HTMLResponse:
    """Shows the work that waits for the visitor, by role."""
    waiting = waiting_for(store, person, now)
    sections = ((kind, heading, [w for w in waiting if w.kind is kind]) for kind, heading in HEADINGS.items())
    return render(request, "review.html", tuple(section for section in sections if section[-1]))
