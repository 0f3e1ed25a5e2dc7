"""The page of a session's certificate and its forms."""

from dataclasses import dataclass
from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, Form, Request, Response
from fastapi.responses import HTMLResponse, RedirectResponse

from service.errors import SignInError
from service.kit.measures import day_of
from service.kit.person import Person
from service.papers.changes import Signing
from service.papers.dependencies import DeskOf
from service.papers.desk import Desk, Papers, SignedIssue, papers_of, sign
from service.papers.records import Meaning, Signature
from service.papers.words import STATES, done_by, moment_of
from service.people.admission import PersonOf, attempt_of
from service.people.dependencies import SEE_OTHER, By, FormLines, FormText, Key, PasswordTurn, StorageOf
from service.people.secret import LONGEST
from service.records.unit_changes import set_customer
from service.sessions.records import StoredSession
from service.sessions.states import RecordState
from service.sessions.store import Sessions
from service.units.records import Customer
from service.web.dependencies import Now
from service.web.fields import Name
from service.web.render import render

RELEASED, REVIEWED, OPEN = "Approved", "Reviewed, not approved yet", "Not signed yet"


@dataclass(frozen=True)
class SignatureView:
    """One signature in words."""

    by: str
    name: str
    login: str
    at: str
    states: str


@dataclass(frozen=True)
class IssueRow:
    """One issue in words."""

    number: str
    issued: str
    who: str
    state: str
    is_approved: bool
    signatures: tuple[SignatureView, ...]
    content_hash: str


@dataclass(frozen=True)
class CertificatePage:
    """Contents of the page of a certificate."""

    session: StoredSession
    counts: bool
    """Whether the session is accepted, so that a certificate can be issued."""
    latest: IssueRow | None
    earlier: tuple[IssueRow, ...]
    """The newest first."""
    concerns: tuple[str, ...]
    signs: Meaning | None
    """The next signature; None where nothing can be signed."""
    states: str
    """Statement of the signer."""
    by: str
    is_account: bool
    """Whether the visitor has an account to sign with."""
    four_eyes: bool
    is_own: bool
    """Whether the visitor has reviewed it, and somebody else must approve."""
    wrong: str
    """Error of the last attempt to sign; empty without one."""


def certificate_page(
    session: StoredSession, papers: Papers, person: Person, *, four_eyes: bool, wrong: str = ""
) -> CertificatePage:
    """The page of a session's certificate for a visitor."""
    rows = tuple(_issue(issue) for issue in papers.certificates)
    signs = None if session.simulated else _next(papers)
    return CertificatePage(
        session=session,
        counts=session.state is RecordState.ACCEPTED,
        latest=rows[-1] if rows else None,
        earlier=tuple(reversed(rows[:-1])),
        concerns=papers.concerns,
        signs=signs,
        states="" if signs is None else STATES[signs],
        by="" if signs is None else done_by(signs),
        is_account=bool(person.login),
        four_eyes=four_eyes,
        is_own=four_eyes and signs is Meaning.APPROVED and rows[-1].signatures[0].login == person.login,
        wrong=wrong,
    )


def _next(papers: Papers) -> Meaning | None:
    """The first missing signature, of an issue with current contents."""
    if not papers.is_current:
        return None
    existing = {signature.meaning for signature in papers.certificates[-1].signatures}
    return next((meaning for meaning in Meaning if meaning not in existing), None)


def _issue(issue: SignedIssue) -> IssueRow:
    return IssueRow(
        number=issue.number,
        issued=day_of(issue.issued_at),
        who=issue.who,
        state=RELEASED if issue.is_approved else REVIEWED if issue.signatures else OPEN,
        is_approved=issue.is_approved,
        signatures=tuple(_signature(signature) for signature in issue.signatures),
        content_hash=issue.content_hash,
    )


def _signature(signature: Signature) -> SignatureView:
    return SignatureView(
        done_by(signature.meaning),
        signature.name,
        signature.login,
        moment_of(signature.signed_at),
        STATES[signature.meaning],
    )


router = APIRouter(include_in_schema=False)


@router.get("/sessions/{id}/certificate")
def show_certificate(request: Request, id: Key, desk: DeskOf, person: PersonOf) -> HTMLResponse:
    """Every issue of the session's certificate, and who signed it."""
    return render(request, "certificate.html", _page(desk, id, person))


def _page(desk: Desk, id: str, person: Person, wrong: str = "") -> CertificatePage:
    papers = papers_of(desk, id)
    with desk.storage.database.reading() as store:
        session = Sessions(store).get(id)
    return certificate_page(session, papers, person, four_eyes=desk.rules.four_eyes, wrong=wrong)


@router.post("/sessions/{id}/certificate/signatures")
def take_signature(
    request: Request,
    id: Key,
    number: Annotated[Name, Form(max_length=60)],
    meaning: Annotated[Meaning, Form()],
    password: Annotated[str, Form(max_length=LONGEST)],
    _: PasswordTurn,
    *,
    desk: DeskOf,
    person: PersonOf,
    now: Now,
) -> Response:
    """Signs the certificate; the page again for a wrong password."""
    signing = Signing(id, number, meaning, person.login, password)
    try:
        sign(desk, signing, attempt_of(request, person.login), now)
    except SignInError as wrong:
        return render(request, "certificate.html", _page(desk, id, person, wrong.detail), wrong.status)
    return RedirectResponse(f"/sessions/{id}/certificate", SEE_OTHER)


@router.post("/units/{serial:path}/customer")
def change_customer(
    serial: Key,
    by: By,
    storage: StorageOf,
    now: Now,
    *,
    name: FormText = "",
    address: FormLines = "",
) -> RedirectResponse:
    """Records for whom the unit is calibrated."""
    set_customer(storage, serial, Customer(name.strip(), address.strip()), now, who=by)
    return RedirectResponse(f"/units/{quote(serial)}#papers", SEE_OTHER)
