"""The addresses of stands: the list, one of them, and the form of its certificate."""

from datetime import date
from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, Form, Request
from fastapi.responses import HTMLResponse, RedirectResponse

from service.dependencies import Now, ReadingFleet, StorageOf
from service.flows.record_stand_certificate import record_stand_certificate
from service.pages.forms import SAYS_SOMETHING, SEE_OTHER, By, Key
from service.pages.group import group_section
from service.pages.render import render
from service.pages.stands import stand_page, stands_page
from service.records.group import Level
from service.records.paper import StandCertificate
from service.views.stand_report import every_stand, stand_report

router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)
Said = Annotated[str, Form(max_length=200, pattern=SAYS_SOMETHING)]
Day = Annotated[date, Form()]


@router.get("/stands")
def show_stands(request: Request, store: ReadingFleet, now: Now) -> HTMLResponse:
    """Every stand, what needs a hand first."""
    return render(request, "stands.html", stands_page(every_stand(store), now))


@router.get("/stands/{name:path}")
def show_stand(request: Request, store: ReadingFleet, now: Now, name: Key) -> HTMLResponse:
    """One stand: may it be used today, and what was measured on it."""
    return render(
        request, "stand.html", stand_page(stand_report(store, name), now, group_section(store, Level.STAND, name))
    )


@router.post("/stands/{name:path}/certificates")
def record_certificate(
    name: Key,
    number: Said,
    issued_by: Said,
    issued_on: Day,
    valid_until: Day,
    *,
    by: By,
    storage: StorageOf,
    now: Now,
) -> RedirectResponse:
    """Keeps the certificate of the stand's own calibration."""
    given = StandCertificate(name, number.strip(), issued_by.strip(), issued_on, valid_until)
    record_stand_certificate(storage, given, now, who=by)
    return RedirectResponse(f"/stands/{quote(name)}#certificates", SEE_OTHER)
