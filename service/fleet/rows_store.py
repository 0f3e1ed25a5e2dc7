"""Queries of reports of the whole fleet: one each, row after row, whatever the size of the fleet."""

from collections.abc import Iterable, Iterator
from typing import Any

from sqlalchemy import Row, Select, func, select
from sqlalchemy.orm import aliased

from service.fleet.tables import ConditionRow
from service.sessions.decision import Decision, Verdict
from service.sessions.history_store import DECIDED, IS_JUDGED, POINT, StoredPoint, point_record
from service.sessions.records import HistoryPoint
from service.sessions.states_store import IS_ACCEPTED, IS_BREAK
from service.sessions.store import decision_record
from service.sessions.tables import DecisionRow, ParameterRow, SessionRow
from service.storage.queries import Queries
from service.types.records import LatestSession
from service.units.records import Service
from service.units.store import service_record
from service.units.tables import ServiceRow, UnitRow

AT_A_TIME = 2000
"""Rows that are held in memory."""

Latest = aliased(SessionRow)


class FleetRows(Queries):
    """Rows of many units, by serial number."""

    def latest_decisions(self, serials: tuple[str, ...]) -> Iterator[tuple[str, str, Decision]]:
        """Serial number, session and decisions of the latest session of some units."""
        query = (
            select(UnitRow.serial, DecisionRow)
            .select_from(ConditionRow)
            .join(UnitRow, UnitRow.id == ConditionRow.unit_id)
            .join(SessionRow, SessionRow.id == ConditionRow.last_session)
            .join(
                DecisionRow, (DecisionRow.session_id == SessionRow.id) & (DecisionRow.revision == SessionRow.revision)
            )
            .where(UnitRow.serial.in_(serials))
            .order_by(UnitRow.serial, DecisionRow.position)
            .execution_options(yield_per=AT_A_TIME)
        )
        for serial, row in self._session.execute(query):
            yield serial, row.session_id, decision_record(row)

    def latest_sessions(self, serials: tuple[str, ...]) -> dict[str, LatestSession]:
        """The session that the verdict of each of some units is of, by serial number."""
        latest = (SessionRow.id, SessionRow.started_at, SessionRow.block, SessionRow.programme, SessionRow.is_reference)
        query = (
            select(UnitRow.serial, UnitRow.id, *latest, SessionRow.temperature, SessionRow.verdict)
            .select_from(ConditionRow)
            .join(UnitRow, UnitRow.id == ConditionRow.unit_id)
            .join(SessionRow, SessionRow.id == ConditionRow.last_session)
            .where(UnitRow.serial.in_(serials))
        )
        return {row[0]: LatestSession(*row[:-1], Verdict(row[-1])) for row in self._session.execute(query)}

    def points_of_latest(self, serials: tuple[str, ...]) -> int:
        """The number of parameters in the latest sessions of some units."""
        query = (
            select(func.count())
            .select_from(ConditionRow)
            .join(SessionRow, SessionRow.id == ConditionRow.last_session)
            .join(
                ParameterRow,
                (ParameterRow.session_id == SessionRow.id) & (ParameterRow.revision == SessionRow.revision),
            )
            .join(UnitRow, UnitRow.id == ConditionRow.unit_id)
            .where(UnitRow.serial.in_(serials), IS_JUDGED)
        )
        return self._session.scalar(query) or 0

    def histories(self, serials: tuple[str, ...], sessions: int) -> Iterator[tuple[str, HistoryPoint]]:
        """The parameters of the newest sessions of some units, so many of each, oldest first."""
        place = func.row_number().over(
            partition_by=SessionRow.unit_id, order_by=(SessionRow.started_at.desc(), SessionRow.id.desc())
        )
        numbered = select(SessionRow.id.label("id"), place.label("place")).join(
            UnitRow, UnitRow.id == SessionRow.unit_id
        )
        newest = numbered.where(UnitRow.serial.in_(serials), IS_ACCEPTED).subquery()
        wanted = select(newest.c.id).where(newest.c.place <= sessions)
        query = _points().where(SessionRow.id.in_(wanted))
        yield from _by_serial(self._session.execute(query.execution_options(yield_per=AT_A_TIME)))

    def worst_histories(self, serials: tuple[str, ...]) -> tuple[tuple[str, HistoryPoint], ...]:
        """Histories of the parameter that sets the latest verdict, for some units."""
        query = (
            _points()
            .join(ConditionRow, ConditionRow.unit_id == UnitRow.id)
            .join(Latest, Latest.id == ConditionRow.last_session)
            .where(
                UnitRow.serial.in_(serials),
                ParameterRow.sensor == Latest.worst_sensor,
                ParameterRow.parameter == Latest.worst_parameter,
            )
        )
        return tuple(_by_serial(self._session.execute(query)))

    def services(self, serials: tuple[str, ...]) -> tuple[Service, ...]:
        """All breaks of some units, oldest first."""
        query = (
            select(ServiceRow, UnitRow.serial)
            .join(UnitRow, UnitRow.id == ServiceRow.unit_id)
            .where(UnitRow.serial.in_(serials), IS_BREAK)
            .order_by(ServiceRow.at, ServiceRow.id)
        )
        return tuple(service_record(row, serial) for row, serial in self._session.execute(query))


def _points() -> Select[*tuple[Any, ...]]:
    return (
        select(UnitRow.serial, *POINT)
        .join(SessionRow, SessionRow.id == ParameterRow.session_id)
        .join(UnitRow, UnitRow.id == SessionRow.unit_id)
        .outerjoin(DecisionRow, DECIDED)
        .where(ParameterRow.revision == SessionRow.revision, IS_ACCEPTED, IS_JUDGED)
        .order_by(
            UnitRow.serial, ParameterRow.at, ParameterRow.session_id, ParameterRow.sensor_index, ParameterRow.parameter
        )
    )


def _by_serial(rows: Iterable[Row[*tuple[Any, ...]]]) -> Iterator[tuple[str, HistoryPoint]]:
    for serial, *row in rows:
        yield serial, point_record(StoredPoint(*row))
