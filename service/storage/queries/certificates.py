"""Numbers of the certificates that were issued."""

from datetime import datetime

from sqlalchemy import select

from service.records.paper import Issue
from service.storage.paper_tables import CertificateRow
from service.storage.queries.base import Queries


class Certificates(Queries):
    """Issues by session; a row is written once."""

    def of_session(self, id: str) -> tuple[Issue, ...]:
        """Every issue of a session's certificate, the first one first."""
        query = select(CertificateRow).where(CertificateRow.session_id == id).order_by(CertificateRow.id)
        return tuple(_issue(row) for row in self._session.scalars(query))

    def add(self, issue: Issue) -> None:
        """Stores an issue; its number is unique."""
        values = {**vars(issue), "session_id": issue.session}
        del values["session"]
        self._session.add(CertificateRow(**values))
        self._session.flush()


def _issue(row: CertificateRow) -> Issue:
    issued_at: datetime = row.issued_at
    return Issue(row.number, row.session_id, row.revision, issued_at, row.who, row.replaces, row.content_hash)
