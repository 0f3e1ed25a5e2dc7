"""Uploads by the time they came, stored or refused: two lists merged, each read on from the same place."""

from datetime import datetime

from sqlalchemy import ColumnElement, and_, or_, select, true

from estimator.errors import Problem
from service.errors import NotFoundError
from service.records.arrival import Arrival, ArrivalQuery, Refusal
from service.storage.queries.base import Queries
from service.storage.queries.sessions import session_record, session_rows
from service.storage.tables import RefusalRow, SessionRow


class Arrivals(Queries):
    """Uploads."""

    def page(self, wanted: ArrivalQuery) -> tuple[Arrival, ...]:
        """The wanted uploads, newest first, in two queries; in three where the list goes on from one."""
        stored_before, refused_before = self._before(wanted)
        found = [Arrival(one.at, None, one) for one in self._refused(wanted, refused_before)]
        if not wanted.refused:
            rows = session_rows().where(stored_before)
            if wanted.text:
                rows = rows.where(SessionRow.filename.icontains(wanted.text, autoescape=True))
            newest = rows.order_by(SessionRow.uploaded_at.desc(), SessionRow.id.desc()).limit(wanted.limit)
            stored = (session_record(*row) for row in self._session.execute(newest))
            found += [Arrival(one.uploaded_at, one, None) for one in stored]
        return tuple(sorted(found, key=lambda arrival: arrival.key, reverse=True)[: wanted.limit])

    def refusal(self, number: int) -> Refusal:
        """One refused upload."""
        row = self._session.get(RefusalRow, number)
        if row is None:
            raise NotFoundError(f"There is no refused upload {number}.")
        return _refusal(row)

    def _refused(self, wanted: ArrivalQuery, before: ColumnElement[bool]) -> tuple[Refusal, ...]:
        query = select(RefusalRow).where(before)
        if wanted.text:
            query = query.where(RefusalRow.filename.icontains(wanted.text, autoescape=True))
        newest = query.order_by(RefusalRow.at.desc(), RefusalRow.id.desc()).limit(wanted.limit)
        return tuple(map(_refusal, self._session.scalars(newest)))

    def _before(self, wanted: ArrivalQuery) -> tuple[ColumnElement[bool], ColumnElement[bool]]:
        """Of sessions and of refusals: which come after the place that the list goes on from."""
        if wanted.after_refusal is not None:
            at = self._session.scalar(select(RefusalRow.at).where(RefusalRow.id == wanted.after_refusal))
            return _after_refusal(at, wanted.after_refusal)
        if wanted.after_session is not None:
            at = self._session.scalar(select(SessionRow.uploaded_at).where(SessionRow.id == wanted.after_session))
            return _after_session(at, wanted.after_session)
        return true(), true()


def _after_refusal(at: datetime | None, number: int) -> tuple[ColumnElement[bool], ColumnElement[bool]]:
    if at is None:
        return true(), true()
    same = and_(RefusalRow.at == at, RefusalRow.id < number)
    return SessionRow.uploaded_at <= at, or_(RefusalRow.at < at, same)


def _after_session(at: datetime | None, id: str) -> tuple[ColumnElement[bool], ColumnElement[bool]]:
    if at is None:
        return true(), true()
    same = and_(SessionRow.uploaded_at == at, SessionRow.id < id)
    return or_(SessionRow.uploaded_at < at, same), RefusalRow.at < at


def _refusal(row: RefusalRow) -> Refusal:
    problems = tuple(Problem(**problem) for problem in row.problems)
    return Refusal(row.id, row.at, row.filename, row.sha256, row.size, problems)
