"""Issues and signs certificates: a new one is made from stored data, an approved one is kept."""

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from hashlib import sha256
from io import BytesIO

from estimator.errors import Problem
from estimator.message import say
from service.diagnosis.records import StoredDiagnosis
from service.errors import ConflictError, DamagedError, NotFoundError, RefusedError
from service.kit.answer import answer
from service.kit.libraries import pypdf
from service.languages.language import Language
from service.papers.certificate import certificate_pdf
from service.papers.certificate.words import certificate
from service.papers.certified import CertifiedSession, certified_session
from service.papers.changes import (
    Signing,
    SigningRules,
    Statement,
    issue_certificate,
    require_signer,
    sign_certificate,
    signature_of,
)
from service.papers.dcc import certificate_dcc
from service.papers.dcc.inputs import inputs_json
from service.papers.records import CertificateFile, Issue, Laboratory, Meaning, Signature, Signed
from service.papers.sealing import Seal
from service.papers.store import Certificates, Signatures
from service.papers.words import CHANGED_HASH, NO_LONGER, NOT_COUNTED
from service.people.changes import SignInAttempt, attempting
from service.sessions.store import Sessions
from service.storage import Storage

UNISSUED = Issue("", "", 0, datetime(1970, 1, 1, tzinfo=UTC), "", None, "")
"""Placeholder for an issue while its contents are hashed."""


def statement_of(found: CertifiedSession) -> Statement:
    """Contents to be issued: the words of the paper, and every number of paper and XML in full.

    The time of upload is not included: the same records have the same contents, in any order of arrival.
    """
    session = found.report.session
    report = replace(found.report, session=replace(session, uploaded_at=UNISSUED.issued_at))
    words = certificate(replace(found, report=report), UNISSUED)
    parts = (
        json.dumps(asdict(words), sort_keys=True).encode(),
        found.calibration_json,
        repr(found.report.decisions).encode(),
        repr(found.history).encode(),
        inputs_json(found).encode(),
    )
    digest = sha256(b"".join(sha256(part).digest() for part in parts)).hexdigest()
    return Statement(session.unit, session.id, session.revision, digest, is_specimen=session.simulated)


DAMAGED = (
    "The approved certificate {number} differs from the stored one and cannot be downloaded: the database was changed."
)
NOT_KEPT = "There is no approved certificate {number} of this session."


@dataclass(frozen=True)
class Desk:
    """Source of certificates."""

    storage: Storage
    diagnosed: Callable[[str], StoredDiagnosis]
    """The diagnosis of a session."""
    laboratory: Laboratory
    rules: SigningRules
    seal: Seal | None
    language: Language = Language.ENGLISH
    """Language of documents for people; a certificate for programs is in English."""

    def written(self, format: str, found: CertifiedSession, issue: Issue, signed: Signed) -> bytes:
        """A certificate in one of its two forms."""
        if format == "dcc":
            return certificate_dcc(found, issue, signed)
        return certificate_pdf(found, issue, signed, self.language)


@dataclass(frozen=True)
class CertificateDocument:
    """A certificate as a file."""

    name: str
    """File name without extension."""
    content: bytes


def certified(desk: Desk, id: str) -> tuple[CertifiedSession, Statement]:
    """Current contents of a session's certificate; ConflictError where the session does not count."""
    found = certified_session(desk.storage, desk.diagnosed(id), desk.laboratory)
    return found, statement_of(found)


def hand_out(desk: Desk, id: str, format: str, now: datetime, *, who: str) -> CertificateDocument:
    """The current certificate, with a new number where its contents are new."""
    return issued(desk, certified(desk, id), format, now, who=who)


def issued(
    desk: Desk, certified_contents: tuple[CertifiedSession, Statement], format: str, now: datetime, *, who: str
) -> CertificateDocument:
    """The certificate of given contents, with a new number where they are new."""
    found, statement = certified_contents
    issue = issue_certificate(desk.storage, statement, now, who=who)
    with desk.storage.database.reading() as store:
        approved = Signatures(store).kept(issue.number, format)
        signatures = Signatures(store).of_certificate(issue.number)
    content = (
        desk.written(format, found, issue, Signed(signatures)) if approved is None else _intact(approved, issue.number)
    )
    return CertificateDocument(_name(found.report.session.unit, issue.number), content)


def hand_out_approved(desk: Desk, id: str, number: str, format: str) -> CertificateDocument:
    """An approved certificate as it was approved, whatever has changed since."""
    with desk.storage.database.reading() as store:
        unit = Sessions(store).get(id).unit
        of_session = any(issue.number == number for issue in Certificates(store).of_session(id))
        approved = Signatures(store).kept(number, format) if of_session else None
    if approved is None:
        raise NotFoundError(NOT_KEPT, number=repr(number))
    return CertificateDocument(_name(unit, number), _intact(approved, number))


def sign(desk: Desk, signing: Signing, attempt: SignInAttempt, now: datetime) -> Signature:
    """Signs the certificate that somebody read, after checking the password."""
    with attempting(desk.storage, attempt, now):
        require_signer(desk.storage, signing)
    found, statement = certified(desk, signing.session)
    with desk.storage.database.reading() as store:
        signature = signature_of(store, signing, statement, desk.rules, now)
        existing = Signatures(store).of_certificate(signing.number)
        issue = Certificates(store).of_session(signing.session)[-1]
    files = _files(desk, found, issue, (*existing, signature)) if signature.meaning is Meaning.APPROVED else ()
    return sign_certificate(desk.storage, signing, statement, desk.rules, signature, files=files)


def _files(
    desk: Desk, found: CertifiedSession, issue: Issue, signatures: tuple[Signature, ...]
) -> tuple[CertificateFile, ...]:
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


def _intact(file: CertificateFile, number: str) -> bytes:
    if sha256(file.content).hexdigest() != file.sha256:
        raise DamagedError(DAMAGED, number=number)
    return file.content


def _name(unit: str, number: str) -> str:
    return f"{unit}-{number}-certificate"


@answer
@dataclass(frozen=True)
class SignedIssue(Issue):
    """One issue of a session's certificate."""

    signatures: tuple[Signature, ...]
    """Signatures under the issue, in the order in which they were given."""

    @property
    def is_approved(self) -> bool:
        """Whether it is released."""
        return any(signature.meaning is Meaning.APPROVED for signature in self.signatures)


@answer
@dataclass(frozen=True)
class Papers:
    """Every issue of a session's certificate."""

    certificates: tuple[SignedIssue, ...]
    """Issues, the first one first; the last one holds."""
    is_current: bool
    """Whether the last one states the currently stored data; another number is due if not."""
    concerns: tuple[str, ...]
    """Reasons against using the last one, in words."""


def papers_of(desk: Desk, id: str) -> Papers:
    """Every issue; the contents of the latest one are compared with the stored data."""
    with desk.storage.database.reading() as store:
        Sessions(store).get(id)
        issued, signatures = Certificates(store).of_session(id), Signatures(store).of_session(id)
    issues = tuple(
        SignedIssue(**vars(issue), signatures=tuple(s for s in signatures if s.certificate == issue.number))
        for issue in issued
    )
    if not issues:
        return Papers((), is_current=False, concerns=())
    latest = issues[-1]
    counts, is_current = _is_current(desk, id, latest)
    checks = ((CHANGED_HASH, _is_altered(latest)), (NOT_COUNTED, not counts), (NO_LONGER, counts and not is_current))
    concerns = (say(words, number=latest.number, done=_done(latest)) for words, holds in checks if holds)
    return Papers(issues, is_current=is_current, concerns=tuple(concerns))


def _is_current(desk: Desk, id: str, issue: Issue) -> tuple[bool, bool]:
    """Whether the session counts, and whether its certificate would have the same contents today."""
    try:
        _, statement = certified(desk, id)
    except ConflictError:
        return False, False
    return True, statement.content_hash == issue.content_hash


def _is_altered(latest: SignedIssue) -> bool:
    """Whether the signed contents differ from those on record."""
    return any(signature.content_hash != latest.content_hash for signature in latest.signatures)


def _done(latest: SignedIssue) -> str:
    return latest.signatures[-1].meaning if latest.signatures else "issued"


NOT_ALL = "Not every one of these sessions has a certificate: leave out those named here. Nothing was issued."


def hand_out_together(desk: Desk, ids: Sequence[str], now: datetime, *, who: str) -> CertificateDocument:
    """The current certificates, each under its number, in one document.

    Raises
    ------
    RefusedError
        A session is not stored or does not count; every such one is named.
    """
    contents, problems = [], list[Problem]()
    for id in dict.fromkeys(ids):
        try:
            contents.append(certified(desk, id))
        except (ConflictError, NotFoundError) as error:
            problems.append(Problem(id, error.detail))
    if problems:
        raise RefusedError(NOT_ALL, tuple(problems))
    papers = [issued(desk, item, "pdf", now, who=who) for item in contents]
    if len(papers) == 1:
        return papers[0]
    return CertificateDocument(f"certificates-{now:%Y-%m-%d}", joined([paper.content for paper in papers]))


def joined(documents: Sequence[bytes]) -> bytes:
    """PDF documents as one, without form fields and signatures."""
    writer = pypdf.PdfWriter()
    for document in documents:
        for page in pypdf.PdfReader(BytesIO(document)).pages:
            writer.add_page(page)
    writer.remove_annotations("/Widget")
    file = BytesIO()
    writer.write(file)
    return file.getvalue()
