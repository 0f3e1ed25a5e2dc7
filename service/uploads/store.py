"""Uploads and their outcomes; remembered layouts."""

from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, and_, or_, select, true

from estimator.errors import Problem
from estimator.json_object import Json
from service.errors import NotFoundError
from service.sessions.store import session_record, session_rows
from service.sessions.tables import SessionRow
from service.storage.json_text import STORED
from service.storage.queries import Queries
from service.uploads.records import Arrival, ArrivalQuery, Refusal
from service.uploads.tables import LayoutRow, RefusalRow


class Arrivals(Queries):
    """Uploads."""

    def page(self, query: ArrivalQuery) -> tuple[Arrival, ...]:
        """The selected uploads, newest first, in two queries; in three where the list continues after one."""
        stored_before, refused_before = self._before(query)
        arrivals = [Arrival(refusal.at, None, refusal) for refusal in self._refused(query, refused_before)]
        if not query.refused:
            rows = session_rows().where(stored_before)
            if query.text:
                rows = rows.where(SessionRow.filename.icontains(query.text, autoescape=True))
            newest = rows.order_by(SessionRow.uploaded_at.desc(), SessionRow.id.desc()).limit(query.limit)
            stored = (session_record(*row) for row in self._session.execute(newest))
            arrivals += [Arrival(refusal.uploaded_at, refusal, None) for refusal in stored]
        return tuple(sorted(arrivals, key=lambda arrival: arrival.key, reverse=True)[: query.limit])

    def refusal(self, number: int) -> Refusal:
        """One refused upload."""
        row = self._session.get(RefusalRow, number)
        if row is None:
            raise NotFoundError("There is no refused upload {number}.", number=number)
        return _refusal(row)

    def _refused(self, filters: ArrivalQuery, before: ColumnElement[bool]) -> tuple[Refusal, ...]:
        query = select(RefusalRow).where(before)
        if filters.text:
            query = query.where(RefusalRow.filename.icontains(filters.text, autoescape=True))
        newest = query.order_by(RefusalRow.at.desc(), RefusalRow.id.desc()).limit(filters.limit)
        return tuple(map(_refusal, self._session.scalars(newest)))

    def _before(self, query: ArrivalQuery) -> tuple[ColumnElement[bool], ColumnElement[bool]]:
        """Conditions for sessions and refusals after the place where the list continues."""
        if query.after_refusal is not None:
            at = self._session.scalar(select(RefusalRow.at).where(RefusalRow.id == query.after_refusal))
            return _after_refusal(at, query.after_refusal)
        if query.after_session is not None:
            at = self._session.scalar(select(SessionRow.uploaded_at).where(SessionRow.id == query.after_session))
            return _after_session(at, query.after_session)
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
    problems = tuple(STORED.read(Problem, problem) for problem in row.problems)
    return Refusal(row.id, row.at, row.filename, row.sha256, row.size, problems)


class Log(Queries):
    """Refused uploads."""

    def refusal(self, at: datetime, filename: str, sha256: str, size: int, problems: Sequence[Problem]) -> int:
        """Records an unusable upload, and returns its number."""
        listed = STORED.written(list(problems))
        row = RefusalRow(at=at, filename=filename, sha256=sha256, size=size, problems=listed)
        self._session.add(row)
        self._session.flush()
        return row.id


class Layouts(Queries):
    """Mappings by the fingerprint of the headings; the last one applies."""

    def remember(self, fingerprint: str, unit_type: str, mapping: Mapping[str, Any], *, who: str, at: datetime) -> None:
        """Stores how files of a layout were read, unless that is known already."""
        if self.find(fingerprint, unit_type, only=True) != mapping:
            values = {"fingerprint": fingerprint, "unit_type": unit_type, "mapping": dict(mapping)}
            self._session.add(LayoutRow(**values, who=who, remembered_at=at))
            self._session.flush()

    def find(self, fingerprint: str, unit_type: str = "", *, only: bool = False) -> Json | None:
        """The mapping for units of a type; unless ``only`` or a type is given, also the last one of any."""
        query = select(LayoutRow.mapping).where(LayoutRow.fingerprint == fingerprint)
        typed = query.where(LayoutRow.unit_type == unit_type).order_by(LayoutRow.id.desc()).limit(1)
        mapping = self._session.scalar(typed)
        if mapping is None and not only and not unit_type:
            mapping = self._session.scalar(query.order_by(LayoutRow.id.desc()).limit(1))
        return mapping
