"""The page of a session's certificate: its issues, who signed them, and the form to sign."""

from dataclasses import dataclass

from service.records.identity import Person
from service.records.session import StoredSession
from service.records.signature import Meaning, Signature
from service.records.state import RecordState
from service.reports.signatures import Papers, SignedIssue
from service.words.names import day_of
from service.words.signature import STATES, done_by, moment_of

RELEASED, REVIEWED, OPEN = "Approved", "Reviewed, not approved yet", "Not signed yet"


@dataclass(frozen=True)
class SignatureRow:
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
    signatures: tuple[SignatureRow, ...]
    content_hash: str


@dataclass(frozen=True)
class CertificatePage:
    """Everything the page of a certificate shows."""

    session: StoredSession
    counts: bool
    """Whether the session is accepted, so that a certificate can be issued."""
    latest: IssueRow | None
    earlier: tuple[IssueRow, ...]
    """The newest first."""
    concerns: tuple[str, ...]
    signs: Meaning | None
    """What can be signed next; None where nothing can."""
    states: str
    """What whoever signs states."""
    by: str
    is_account: bool
    """Whether the one who looks has an account to sign with."""
    four_eyes: bool
    is_own: bool
    """Whether the one who looks has reviewed it, and somebody else must approve."""
    wrong: str
    """What was wrong with the last try to sign; empty where nothing was."""


def certificate_page(
    session: StoredSession, papers: Papers, person: Person, *, four_eyes: bool, wrong: str = ""
) -> CertificatePage:
    """The page of a session's certificate as somebody sees it."""
    rows = tuple(_issue(one) for one in papers.certificates)
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
    """The first that nobody has signed, of an issue that states what is stored."""
    if not papers.is_current:
        return None
    given = {signature.meaning for signature in papers.certificates[-1].signatures}
    return next((meaning for meaning in Meaning if meaning not in given), None)


def _issue(one: SignedIssue) -> IssueRow:
    return IssueRow(
        number=one.number,
        issued=day_of(one.issued_at),
        who=one.who,
        state=RELEASED if one.is_approved else REVIEWED if one.signatures else OPEN,
        is_approved=one.is_approved,
        signatures=tuple(_signature(signature) for signature in one.signatures),
        content_hash=one.content_hash,
    )


def _signature(one: Signature) -> SignatureRow:
    return SignatureRow(done_by(one.meaning), one.name, one.login, moment_of(one.signed_at), STATES[one.meaning])
