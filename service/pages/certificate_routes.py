"""The addresses of a session's certificate: the page with its signatures, and the form that signs it."""

from typing import Annotated

from fastapi import APIRouter, Form, Request, Response
from fastapi.responses import HTMLResponse, RedirectResponse

from service.admission import PersonOf, attempt_of
from service.dependencies import DeskOf, Now, Reading
from service.errors import SignInError
from service.flows.sign_certificate import Signing
from service.identity.passwords import LONGEST
from service.pages.certificate import certificate_page
from service.pages.forms import NO_NUL, SAYS_SOMETHING, SEE_OTHER, Key
from service.pages.render import render
from service.records.signature import Meaning
from service.reports.desk import sign
from service.reports.signatures import papers_of

router = APIRouter(include_in_schema=False)


@router.get("/sessions/{id}/certificate")
def show_certificate(request: Request, id: Key, store: Reading, desk: DeskOf, person: PersonOf) -> HTMLResponse:
    """Every issue of the session's certificate, and who signed it."""
    four_eyes = desk.rules.four_eyes
    page = certificate_page(store.sessions.get(id), papers_of(desk, id), person, four_eyes=four_eyes)
    return render(request, "certificate.html", page)


@router.post("/sessions/{id}/certificate/signatures")
def take_signature(
    request: Request,
    id: Key,
    number: Annotated[str, Form(max_length=60, pattern=SAYS_SOMETHING)],
    meaning: Annotated[Meaning, Form()],
    password: Annotated[str, Form(max_length=LONGEST, pattern=NO_NUL)],
    *,
    desk: DeskOf,
    person: PersonOf,
    now: Now,
) -> Response:
    """Puts a name under the certificate; the page again where the password is wrong."""
    signing = Signing(id, number, meaning, person.login, password)
    try:
        sign(desk, signing, attempt_of(request, person.login), now)
    except SignInError as wrong:
        papers, four_eyes = papers_of(desk, id), desk.rules.four_eyes
        with desk.storage.database.reading() as store:
            session = store.sessions.get(id)
        page = certificate_page(session, papers, person, four_eyes=four_eyes, wrong=wrong.detail)
        return render(request, "certificate.html", page, wrong.status)
    return RedirectResponse(f"/sessions/{id}/certificate", SEE_OTHER)
