"""The addresses of what papers name: certificates of stands, and for whom a unit is calibrated."""

from datetime import date
from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, Form, Request
from fastapi.responses import HTMLResponse, RedirectResponse

from service.dependencies import Now, Reading, StorageOf
from service.flows.record_stand_certificate import record_stand_certificate
from service.flows.set_customer import set_customer
from service.pages.forms import NO_NUL, SAYS_SOMETHING, SEE_OTHER, By, Key
from service.pages.render import render
from service.pages.stand_certificates import stand_certificates_page
from service.records.paper import Customer, StandCertificate

router = APIRouter(include_in_schema=False)
Said = Annotated[str, Form(max_length=200, pattern=SAYS_SOMETHING)]
Day = Annotated[date, Form()]


@router.get("/stand-certificates")
def show_stand_certificates(request: Request, store: Reading, now: Now) -> HTMLResponse:
    """Every stand with the certificates of its own calibration."""
    page = stand_certificates_page(store.stand_certificates.every(), now.date())
    return render(request, "stand_certificates.html", page)


@router.post("/stand-certificates")
def record(
    stand: Said,
    number: Said,
    issued_by: Said,
    issued_on: Day,
    valid_until: Day,
    *,
    by: By,
    storage: StorageOf,
    now: Now,
) -> RedirectResponse:
    """Keeps the certificate of a stand."""
    given = StandCertificate(stand, number.strip(), issued_by.strip(), issued_on, valid_until)
    record_stand_certificate(storage, given, now, who=by)
    return RedirectResponse("/stand-certificates", SEE_OTHER)


@router.post("/units/{serial:path}/customer")
def change_customer(
    serial: Key,
    by: By,
    storage: StorageOf,
    now: Now,
    *,
    name: Annotated[str, Form(max_length=200, pattern=NO_NUL)] = "",
    address: Annotated[str, Form(max_length=2000, pattern=NO_NUL)] = "",
) -> RedirectResponse:
    """Records for whom the unit is calibrated."""
    set_customer(storage, serial, Customer(name.strip(), address.strip()), now, who=by)
    return RedirectResponse(f"/units/{quote(serial)}#papers", SEE_OTHER)
