"""What came in and what became of it; layouts that are known."""

from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, and_, or_, select, true

from estimator.errors import Problem
from estimator.json_object import Json
from estimator.message import say
from service.errors import NotFoundError
from service.sessions.store import session_record, session_rows
from service.sessions.tables import SessionRow
from service.storage.json_text import STORED
from service.storage.queries import Queries
from service.uploads.records import Arrival, ArrivalQuery, Refusal
from service.uploads.tables import LayoutRow, RefusalRow


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
            raise NotFoundError(say("There is no refused upload {number}.", number=number))
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
    problems = tuple(STORED.read(Problem, problem) for problem in row.problems)
    return Refusal(row.id, row.at, row.filename, row.sha256, row.size, problems)


class Log(Queries):
    """Refused uploads."""

    def refusal(self, at: datetime, filename: str, sha256: str, size: int, problems: Sequence[Problem]) -> int:
        """Records an upload that could not be used, and returns its number."""
        listed = STORED.written(list(problems))
        row = RefusalRow(at=at, filename=filename, sha256=sha256, size=size, problems=listed)
        self._session.add(row)
        self._session.flush()
        return row.id


class Layouts(Queries):
    """Mappings by the fingerprint of the headings; the last one holds."""

    def remember(self, fingerprint: str, unit_type: str, mapping: Mapping[str, Any], *, who: str, at: datetime) -> None:
        """Stores how files of a layout were read, unless that is known already."""
        if self.find(fingerprint, unit_type, only=True) != mapping:
            own = {"fingerprint": fingerprint, "unit_type": unit_type, "mapping": dict(mapping)}
            self._session.add(LayoutRow(**own, who=who, remembered_at=at))
            self._session.flush()

    def find(self, fingerprint: str, unit_type: str = "", *, only: bool = False) -> Json | None:
        """The mapping for units of a type, or else unless ``only`` for that type's, the last one of any."""
        query = select(LayoutRow.mapping).where(LayoutRow.fingerprint == fingerprint)
        own = query.where(LayoutRow.unit_type == unit_type).order_by(LayoutRow.id.desc()).limit(1)
        found = self._session.scalar(own)
        if found is None and not only and not unit_type:
            found = self._session.scalar(query.order_by(LayoutRow.id.desc()).limit(1))
        return found
