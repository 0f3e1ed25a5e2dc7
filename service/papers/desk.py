"""Where certificates are handed out and signed: a new one is made of what is stored, an approved one is kept."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from hashlib import sha256

from estimator.message import say
from service.diagnosis.records import StoredDiagnosis
from service.errors import DamagedError, NotFoundError
from service.languages.language import Language
from service.papers.certificate import certificate_pdf
from service.papers.certificate.content import statement_of
from service.papers.certificate.signed import Signed
from service.papers.certified import CertifiedSession, certified_session
from service.papers.changes import (
    Rules,
    Signing,
    Statement,
    issue_certificate,
    require_signer,
    sign_certificate,
    signature_of,
)
from service.papers.dcc import certificate_dcc
from service.papers.records import CertificateFile, Issue, Laboratory, Meaning, Signature
from service.papers.sealing import Seal
from service.papers.store import Certificates, Signatures
from service.people.changes import Attempt, attempting
from service.sessions.store import Sessions
from service.storage import Storage

DAMAGED = "The approved certificate {number} is not what was kept, and is not given out: the database was changed."
NOT_KEPT = "There is no approved certificate {number} of this session."


@dataclass(frozen=True)
class Desk:
    """What certificates are made from."""

    storage: Storage
    diagnosed: Callable[[str], StoredDiagnosis]
    """The diagnosis of a session."""
    laboratory: Laboratory
    rules: Rules
    seal: Seal | None
    language: Language = Language.ENGLISH
    """Of what is made for people; a certificate for programs speaks English."""

    def written(self, format: str, found: CertifiedSession, issue: Issue, signed: Signed) -> bytes:
        """A certificate in one of its two forms."""
        if format == "dcc":
            return certificate_dcc(found, issue, signed)
        return certificate_pdf(found, issue, signed, self.language)


@dataclass(frozen=True)
class HandedOut:
    """A certificate as a file."""

    name: str
    """Without its ending."""
    content: bytes


def certified(desk: Desk, id: str) -> tuple[CertifiedSession, Statement]:
    """What a certificate of the session would state now; ConflictError where the session does not count."""
    found = certified_session(desk.storage, desk.diagnosed(id), desk.laboratory)
    return found, statement_of(found)


def hand_out(desk: Desk, id: str, format: str, now: datetime, *, who: str) -> HandedOut:
    """The certificate that holds, under a new number where it states something new."""
    return issued(desk, certified(desk, id), format, now, who=who)


def issued(
    desk: Desk, stated: tuple[CertifiedSession, Statement], format: str, now: datetime, *, who: str
) -> HandedOut:
    """The same of what a certificate would state."""
    found, statement = stated
    issue = issue_certificate(desk.storage, statement, now, who=who)
    with desk.storage.database.reading() as store:
        kept = Signatures(store).kept(issue.number, format)
        signatures = Signatures(store).of_certificate(issue.number)
    content = desk.written(format, found, issue, Signed(signatures)) if kept is None else _intact(kept, issue.number)
    return HandedOut(_name(found.report.session.unit, issue.number), content)


def hand_out_approved(desk: Desk, id: str, number: str, format: str) -> HandedOut:
    """An approved certificate as it was approved, whatever has changed since."""
    with desk.storage.database.reading() as store:
        unit = Sessions(store).get(id).unit
        of_session = any(issue.number == number for issue in Certificates(store).of_session(id))
        kept = Signatures(store).kept(number, format) if of_session else None
    if kept is None:
        raise NotFoundError(say(NOT_KEPT, number=repr(number)))
    return HandedOut(_name(unit, number), _intact(kept, number))


def sign(desk: Desk, signing: Signing, attempt: Attempt, now: datetime) -> Signature:
    """Puts a name under the certificate that somebody read, once their password is right."""
    with attempting(desk.storage, attempt, now):
        require_signer(desk.storage, signing)
    found, statement = certified(desk, signing.session)
    with desk.storage.database.reading() as store:
        signature = signature_of(store, signing, statement, desk.rules, now)
        given = Signatures(store).of_certificate(signing.number)
        issue = Certificates(store).of_session(signing.session)[-1]
    files = _files(desk, found, issue, (*given, signature)) if signature.meaning is Meaning.APPROVED else ()
    return sign_certificate(desk.storage, signing, statement, desk.rules, signature, files=files)


def _files(
    desk: Desk, found: CertifiedSession, issue: Issue, signatures: tuple[Signature, ...]
) -> tuple[CertificateFile, ...]:
    """An approved certificate in every format, sealed where the laboratory has a key."""
    seal, sealed_by = desk.seal, ""
    if seal is not None:
        seal.require_valid(signatures[-1].signed_at)
        sealed_by = seal.subject
    signed = Signed(signatures, sealed_by)
    pdf, dcc = (desk.written(format, found, issue, signed) for format in ("pdf", "dcc"))
    if seal is not None:
        pdf, dcc = seal.pdf(pdf), seal.xml(dcc)
    return tuple(
        CertificateFile(format, content, sha256(content).hexdigest(), sealed_by)
        for format, content in (("pdf", pdf), ("dcc", dcc))
    )


def _intact(kept: CertificateFile, number: str) -> bytes:
    if sha256(kept.content).hexdigest() != kept.sha256:
        raise DamagedError(say(DAMAGED, number=number))
    return kept.content


def _name(unit: str, number: str) -> str:
    return f"{unit}-{number}-certificate"
