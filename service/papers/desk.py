"""Where certificates are handed out and signed: a new one is made of what is stored, an approved one is kept."""

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from hashlib import sha256
from io import BytesIO

from pypdf import PdfReader, PdfWriter

from estimator.errors import Problem
from estimator.message import say
from service.diagnosis.records import StoredDiagnosis
from service.errors import ConflictError, DamagedError, NotFoundError, RefusedError
from service.kit.answer import answer
from service.languages.language import Language
from service.papers.certificate import certificate_pdf
from service.papers.certificate.words import Signed, certificate
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
from service.papers.words import CHANGED_HASH, NO_LONGER, NOT_COUNTED
from service.people.changes import Attempt, attempting
from service.sessions.store import Sessions
from service.storage import Storage

UNISSUED = Issue("", "", 0, datetime(1970, 1, 1, tzinfo=UTC), "", None, "")
"""Stands in for an issue while what it states is being hashed."""


def statement_of(found: CertifiedSession) -> Statement:
    """What is about to be issued: the words of the paper, and every number in full that paper or XML rests on.

    When its records were received is no part of it: the same records state the same, in whatever order they came.
    """
    session = found.report.session
    report = replace(found.report, session=replace(session, uploaded_at=UNISSUED.issued_at))
    words = certificate(replace(found, report=report), UNISSUED)
    parts = (
        json.dumps(asdict(words), sort_keys=True).encode(),
        found.calibration_json,
        repr(found.report.decisions).encode(),
        repr(found.history).encode(),
    )
    digest = sha256(b"".join(sha256(part).digest() for part in parts)).hexdigest()
    return Statement(session.unit, session.id, session.revision, digest, is_specimen=session.simulated)


DAMAGED = (
    "The approved certificate {number} differs from the stored one and cannot be downloaded: the database was changed."
)
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


@answer
@dataclass(frozen=True)
class SignedIssue(Issue):
    """One issue of a session's certificate."""

    signatures: tuple[Signature, ...]
    """Who signed it, in their order."""

    @property
    def is_approved(self) -> bool:
        """Whether it is released."""
        return any(signature.meaning is Meaning.APPROVED for signature in self.signatures)


@answer
@dataclass(frozen=True)
class Papers:
    """Every issue of a session's certificate."""

    certificates: tuple[SignedIssue, ...]
    """The first one first; the last one holds."""
    is_current: bool
    """Whether the last one states what is stored now; another number is due if not."""
    concerns: tuple[str, ...]
    """What speaks against using the last one, in words."""


def papers_of(desk: Desk, id: str) -> Papers:
    """Every issue; of the latest one what it rests on is worked out again and compared."""
    with desk.storage.database.reading() as store:
        Sessions(store).get(id)
        issued, signatures = Certificates(store).of_session(id), Signatures(store).of_session(id)
    issues = tuple(
        SignedIssue(**vars(one), signatures=tuple(s for s in signatures if s.certificate == one.number))
        for one in issued
    )
    if not issues:
        return Papers((), is_current=False, concerns=())
    latest = issues[-1]
    counts, is_current = _compared(desk, id, latest)
    told = ((CHANGED_HASH, _is_other(latest)), (NOT_COUNTED, not counts), (NO_LONGER, counts and not is_current))
    concerns = (say(words, number=latest.number, done=_done(latest)) for words, holds in told if holds)
    return Papers(issues, is_current=is_current, concerns=tuple(concerns))


def _compared(desk: Desk, id: str, issue: Issue) -> tuple[bool, bool]:
    """Whether the session counts, and whether its certificate would state the same today."""
    try:
        _, statement = certified(desk, id)
    except ConflictError:
        return False, False
    return True, statement.content_hash == issue.content_hash


def _is_other(latest: SignedIssue) -> bool:
    """Whether something else was signed than is on record."""
    return any(signature.content_hash != latest.content_hash for signature in latest.signatures)


def _done(latest: SignedIssue) -> str:
    return latest.signatures[-1].meaning if latest.signatures else "issued"


NOT_ALL = "Not every one of these sessions has a certificate: leave out those named here. Nothing was issued."


def hand_out_together(desk: Desk, ids: Sequence[str], now: datetime, *, who: str) -> HandedOut:
    """The certificates that hold, each under its number, page after page.

    Raises
    ------
    RefusedError
        A session is not stored or does not count; every such one is named.
    """
    stated, problems = [], list[Problem]()
    for id in dict.fromkeys(ids):
        try:
            stated.append(certified(desk, id))
        except (ConflictError, NotFoundError) as error:
            problems.append(Problem(id, error.detail))
    if problems:
        raise RefusedError(NOT_ALL, tuple(problems))
    papers = [issued(desk, one, "pdf", now, who=who) for one in stated]
    if len(papers) == 1:
        return papers[0]
    return HandedOut(f"certificates-{now:%Y-%m-%d}", joined([paper.content for paper in papers]))


def joined(documents: Sequence[bytes]) -> bytes:
    """PDF documents as one, without what is filled in or signed in them."""
    writer = PdfWriter()
    for document in documents:
        for page in PdfReader(BytesIO(document)).pages:
            writer.add_page(page)
    writer.remove_annotations("/Widget")
    file = BytesIO()
    writer.write(file)
    return file.getvalue()
