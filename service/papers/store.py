"""Numbers of certificates, their signatures, and approved certificates."""

from collections.abc import Sequence
from datetime import UTC, date, datetime, time, timedelta

from sqlalchemy import Select, exists, func, or_, select
from sqlalchemy.orm import aliased

from service.errors import ConflictError, NotFoundError
from service.papers.records import CertificateFile, Issue, Meaning, RestingCertificate, Signature
from service.papers.tables import CertificateFileRow, CertificateRow, SignatureRow
from service.people.tables import AccountRow
from service.sessions.records import ID_DIGITS, UNWEIGHED
from service.sessions.states_store import IS_ACCEPTED
from service.sessions.tables import SessionRow
from service.stands.tables import StandRow
from service.storage.queries import Queries
from service.units.tables import UnitRow


class Certificates(Queries):
    """Issues by session; a row is written once."""

    def of_session(self, id: str) -> tuple[Issue, ...]:
        """Every issue of a session's certificate, the first one first."""
        query = select(CertificateRow).where(CertificateRow.session_id == id).order_by(CertificateRow.id)
        return tuple(_issue(row) for row in self._session.scalars(query))

    def resting_on(self, stand: str, since: date, until: date) -> tuple[RestingCertificate, ...]:
        """Every issue of sessions that were measured on a stand in these days, or judged against one that was."""
        first, last = (datetime.combine(day, time(), UTC) for day in (since, until + timedelta(days=1)))
        there = (
            select(SessionRow.id)
            .join(StandRow, StandRow.id == SessionRow.stand_id)
            .where(StandRow.name == stand, SessionRow.started_at >= first, SessionRow.started_at < last)
        )
        against = (func.substr(SessionRow.basis, start, ID_DIGITS).in_(there) for start in (1, 1 + len(UNWEIGHED)))
        measured_there = SessionRow.id.in_(there)
        issued = (CertificateRow.number, UnitRow.serial, SessionRow.id, SessionRow.started_at, CertificateRow.issued_at)
        query = (
            select(*issued, measured_there)
            .join(SessionRow, SessionRow.id == CertificateRow.session_id)
            .join(UnitRow, UnitRow.id == SessionRow.unit_id)
            .where(or_(measured_there, *against))
            .order_by(SessionRow.started_at, CertificateRow.id)
        )
        return tuple(RestingCertificate(*row[:-1], bool(row[-1])) for row in self._session.execute(query))

    def unsigned(self, most: int) -> tuple[tuple[Issue, str, Meaning | None], ...]:
        """Newest issues of sessions that count and were measured, not approved yet, with their unit and last signature;
        where nobody ever signed, none."""
        certificate, later = CertificateRow, aliased(CertificateRow)
        signed = select(SignatureRow.meaning).where(SignatureRow.certificate_id == certificate.id)
        reviewed, approved = (signed.where(SignatureRow.meaning == meaning).exists() for meaning in Meaning)
        replaced = exists().where(later.session_id == certificate.session_id, later.id > certificate.id)
        query = (
            select(certificate, UnitRow.serial, reviewed)
            .join(SessionRow, SessionRow.id == certificate.session_id)
            .join(UnitRow, UnitRow.id == SessionRow.unit_id)
            .where(~approved, ~replaced, IS_ACCEPTED, UnitRow.simulated.is_(False), select(SignatureRow.id).exists())
            .order_by(certificate.id.desc())
        )
        rows = self._session.execute(query.limit(most))
        return tuple((_issue(row), serial, Meaning.REVIEWED if seen else None) for row, serial, seen in rows)

    def add(self, issue: Issue) -> None:
        """Stores an issue; its number is unique."""
        values = {**vars(issue), "session_id": issue.session}
        del values["session"]
        self._session.add(CertificateRow(**values))
        self._session.flush()


def _issue(row: CertificateRow) -> Issue:
    issued_at: datetime = row.issued_at
    return Issue(row.number, row.session_id, row.revision, issued_at, row.who, row.replaces, row.content_hash)


class Signatures(Queries):
    """Signatures by the certificate's number or its session; a row is written once."""

    def of_session(self, id: str) -> tuple[Signature, ...]:
        """The signatures under every issue of a session's certificate, the first one first."""
        query = _signatures().where(CertificateRow.session_id == id).order_by(SignatureRow.id)
        return tuple(_signature(*row) for row in self._session.execute(query))

    def of_certificate(self, number: str) -> tuple[Signature, ...]:
        """The signatures under one issue."""
        query = _signatures().where(CertificateRow.number == number).order_by(SignatureRow.id)
        return tuple(_signature(*row) for row in self._session.execute(query))

    def add(self, signature: Signature, account: int) -> None:
        """Stores a signature; ConflictError where somebody signed the same at the same moment."""
        values = {
            "certificate_id": self._key(signature.certificate),
            "meaning": signature.meaning,
            "account_id": account,
            "name": signature.name,
            "signed_at": signature.signed_at,
            "content_hash": signature.content_hash,
        }
        if not self.insert_once(SignatureRow, **values):
            parts = {"certificate": signature.certificate, "meaning": signature.meaning}
            raise ConflictError("Certificate {certificate} is {meaning} already.", **parts)

    def keep(self, number: str, files: Sequence[CertificateFile]) -> None:
        """Stores the files of an approved issue."""
        key = self._key(number)
        self._session.add_all(CertificateFileRow(certificate_id=key, **vars(file)) for file in files)

    def kept(self, number: str, format: str) -> CertificateFile | None:
        """The file of an approved issue; None without approval."""
        query = select(CertificateFileRow).join(CertificateRow).where(CertificateRow.number == number)
        row = self._session.scalar(query.where(CertificateFileRow.format == format))
        return None if row is None else CertificateFile(row.format, row.content, row.sha256, row.sealed_by)

    def _key(self, number: str) -> int:
        key = self._session.scalar(select(CertificateRow.id).where(CertificateRow.number == number))
        if key is None:
            raise NotFoundError("There is no certificate {number}.", number=repr(number))
        return key


def _signatures() -> Select[SignatureRow, str, str]:
    columns = select(SignatureRow, CertificateRow.number, AccountRow.login)
    return columns.join(CertificateRow, CertificateRow.id == SignatureRow.certificate_id).join(
        AccountRow, AccountRow.id == SignatureRow.account_id
    )


def _signature(row: SignatureRow, number: str, login: str) -> Signature:
    signed_at: datetime = row.signed_at
    return Signature(number, Meaning(row.meaning), login, row.name, signed_at, row.content_hash)
