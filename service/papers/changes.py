"""Numbers and signatures of certificates.

A certificate is reviewed first and approved by somebody else. The signature is bound to the hash of the contents, and
possible only while the stored data are the same; an approved certificate is kept byte by byte.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from service.errors import ConflictError, ForbiddenError, SignInError
from service.kit.person import Role
from service.papers.records import CertificateFile, Issue, Meaning, Signature
from service.papers.store import Certificates, Signatures
from service.papers.words import STATES
from service.people.secret import is_password
from service.people.store import Accounts
from service.storage import Storage
from service.storage.audit import Audit
from service.storage.queries import Store
from service.units.store import Units

SPECIMEN = "specimen-"
"""Prefix of the number of a simulated session's specimen: no certificate has such a number."""


@dataclass(frozen=True)
class Statement:
    """Contents of a certificate to be issued."""

    unit: str
    session: str
    revision: int
    content_hash: str
    """SHA-256 of the contents."""
    is_specimen: bool = False
    """Whether the session was simulated, so that it certifies nothing."""


def issue_certificate(storage: Storage, statement: Statement, now: datetime, *, who: str) -> Issue:
    """The issue with these contents: the latest one of the session, or a new one that replaces it."""
    with storage.database.writing() as store:
        Units(store).hold(statement.unit)
        issued = Certificates(store).of_session(statement.session)
        if issued and issued[-1].content_hash == statement.content_hash:
            return issued[-1]
        new = Issue(
            number=f"{SPECIMEN * statement.is_specimen}{statement.session}-{statement.revision}-{len(issued) + 1}",
            session=statement.session,
            revision=statement.revision,
            issued_at=now,
            who=who,
            replaces=issued[-1].number if issued else None,
            content_hash=statement.content_hash,
        )
        Certificates(store).add(new)
        Audit(store).write(now, who, "certificate", new.number, {"replaces": new.replaces})
    return new


NEEDED_ROLE = Role.ENGINEER
"""Role needed to sign: people who may judge may also sign."""
WRONG = "The password is wrong. Nothing was signed."
NO_ACCOUNT = "Signing requires an account: make one and sign in with it."
NOT_ISSUED = "There is no certificate to sign yet: ask for it, read it, then sign it."
REPLACED = "Certificate {number} is not the latest one: {latest} is. Read that one."
CHANGED = (
    "The data of certificate {number} have changed since it was issued. Request the certificate again, read it, and "
    "sign the new one."
)
NOT_REVIEWED = "Certificate {number} must be reviewed before it is approved."
SAME_PERSON = "You have reviewed certificate {number}: another person must approve it."
IS_SPECIMEN = "The session is simulated: its certificate is a specimen and cannot be signed."
ALREADY = "Certificate {number} is {meaning} already, by {name}."


@dataclass(frozen=True)
class Signing:
    """A signature to be made."""

    session: str
    number: str
    """Number of the certificate that the signer read."""
    meaning: Meaning
    login: str
    password: str


@dataclass(frozen=True)
class SigningRules:
    """Signing rules of a laboratory."""

    four_eyes: bool = True
    """Whether reviewer and approver must be two people."""


def require_signer(storage: Storage, signing: Signing) -> str:
    """The name to be printed; SignInError for a wrong password."""
    if not signing.login:
        raise ConflictError(NO_ACCOUNT)
    with storage.database.reading() as store:
        stored = Accounts(store).password_hash(signing.login)
        account = Accounts(store).get(signing.login)
    if not is_password(stored, signing.password):
        raise SignInError(WRONG)
    if not account.role.may(NEEDED_ROLE):
        parts = {"needed_role": NEEDED_ROLE, "login": account.login, "role": account.role}
        raise ForbiddenError("Signing a certificate needs the role {needed_role}; {login} is {role}.", **parts)
    return account.name


def signature_of(store: Store, signing: Signing, statement: Statement, rules: SigningRules, now: datetime) -> Signature:
    """The signature to be written; ConflictError where it is not allowed."""
    if statement.is_specimen:
        raise ConflictError(IS_SPECIMEN)
    issue = _latest(store, signing)
    if issue.content_hash != statement.content_hash:
        raise ConflictError(CHANGED, number=issue.number)
    before = {signature.meaning: signature for signature in Signatures(store).of_certificate(issue.number)}
    if signing.meaning in before:
        existing = before[signing.meaning]
        raise ConflictError(ALREADY, number=issue.number, meaning=existing.meaning, name=existing.name)
    account = Accounts(store).get(signing.login)
    if signing.meaning is Meaning.APPROVED:
        _require_review(before.get(Meaning.REVIEWED), issue, account.login, rules)
    return Signature(issue.number, signing.meaning, account.login, account.name, now, issue.content_hash)


def _latest(store: Store, signing: Signing) -> Issue:
    issued = Certificates(store).of_session(signing.session)
    if not issued:
        raise ConflictError(NOT_ISSUED)
    if issued[-1].number != signing.number:
        raise ConflictError(REPLACED, number=signing.number, latest=issued[-1].number)
    return issued[-1]


def _require_review(review: Signature | None, issue: Issue, login: str, rules: SigningRules) -> None:
    if review is None:
        raise ConflictError(NOT_REVIEWED, number=issue.number)
    if rules.four_eyes and review.login == login:
        raise ConflictError(SAME_PERSON, number=issue.number)


def sign_certificate(
    storage: Storage,
    signing: Signing,
    statement: Statement,
    rules: SigningRules,
    signature: Signature,
    *,
    files: Sequence[CertificateFile] = (),
) -> Signature:
    """Writes a signature, and for an approval the files of the certificate."""
    with storage.database.writing() as store:
        Units(store).hold(statement.unit)
        current = signature_of(store, signing, statement, rules, signature.signed_at)
        if current != signature:
            raise ConflictError(CHANGED, number=signature.certificate)
        Signatures(store).add(signature, Accounts(store).get(signature.login).id)
        Signatures(store).keep(signature.certificate, files)
        details = {
            "meaning": signature.meaning,
            "states": STATES[signature.meaning],
            "content_hash": signature.content_hash,
            "files": {file.format: file.sha256 for file in files},
        }
        Audit(store).write(signature.signed_at, signature.name, "sign certificate", signature.certificate, details)
    return signature
