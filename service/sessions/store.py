"""Sessions and their decisions."""

from collections.abc import Collection, Sequence
from dataclasses import asdict, fields
from datetime import datetime
from typing import Any

from sqlalchemy import (
    ColumnElement,
    ScalarSelect,
    Select,
    SQLColumnExpression,
    and_,
    bindparam,
    case,
    func,
    or_,
    select,
    update,
)
from sqlalchemy.orm import InstrumentedAttribute, aliased

from estimator.health.common_motion import CommonMotion
from estimator.health.temperature_law import Steps, TemperatureCorrection
from estimator.json_object import Json
from estimator.session import CALIBRATIONS
from service.diagnosis.tables import DiagnosisRow
from service.errors import NotFoundError
from service.kit.arriving_files import DEMONSTRATION
from service.kit.copying import copied
from service.kit.moments import local, offset_minutes
from service.sessions.decision import Decision, Verdict
from service.sessions.doubt import Reservation, Reservations
from service.sessions.records import (
    UNWEIGHED,
    Achieved,
    DiagnosisState,
    Digests,
    SessionOrder,
    SessionQuery,
    StoredSession,
)
from service.sessions.states import RecordState
from service.sessions.states_store import IS_ACCEPTED, IS_BREAK
from service.sessions.tables import CommonMotionRow, DecisionRow, SessionRow
from service.stands.tables import StandRow
from service.storage.audit import AuditRow
from service.storage.json_text import STORED
from service.storage.listing import Key, Listing
from service.storage.queries import Queries, lists
from service.types.tables import UnitTypeRow
from service.units.tables import ServiceRow, UnitRow

NOT_JUDGED = ""
"""Basis of the verdict of a session that is still to be judged, or judged again."""


def is_waiting(basis: InstrumentedAttribute[str | None]) -> ColumnElement[bool]:
    """Whether a session is to be judged, or to be weighed beside its verdict."""
    return or_(basis == NOT_JUDGED, basis.startswith(UNWEIGHED))


MOST_ACHIEVED = 10_000
"""Changes by which tolerances are proposed: those of some hundred sessions."""


class Sessions(Queries):
    """Uploaded sessions and their decisions."""

    def by_hash(self, sha256: str) -> StoredSession | None:
        """The session made of these bytes, if they were uploaded before."""
        found = self._session.execute(_BY_HASH, {"sha256": sha256}).one_or_none()
        return None if found is None else session_record(*found)

    def same(self, sha256: str, digest: str) -> StoredSession | None:
        """The session made of these bytes, or else of this content, whatever the format of its file."""
        rows = self._session.execute(_SAME, {"sha256": sha256, "digest": digest})
        found = [session_record(*row) for row in rows]
        return min(found, key=lambda session: session.sha256 != sha256, default=None)

    def get(self, id: str) -> StoredSession:
        """One session."""
        found = self._session.execute(_BY_ID, {"id": id}).one_or_none()
        if found is None:
            raise NotFoundError("There is no session {id}.", id=repr(id))
        return session_record(*found)

    def only_demonstration(self) -> bool:
        """Whether there is a demonstration to look at, and nothing that anybody uploaded."""
        is_real = select(UnitRow.id).where(UnitRow.simulated.is_(False)).limit(1)
        is_any = select(UnitRow.id).limit(1)
        is_own = select(AuditRow.id).where(AuditRow.action == "upload", AuditRow.who != DEMONSTRATION).limit(1)
        found = (self._session.scalar(query) is not None for query in (is_any, is_real, is_own))
        return tuple(found) == (True, False, False)

    def any_stands(self, unit: str) -> bool:
        """Whether a unit has a session that counts or waits for somebody to say whether it does."""
        states = (RecordState.ACCEPTED, RecordState.QUESTIONED)
        query = select(SessionRow.id).join(UnitRow, UnitRow.id == SessionRow.unit_id).where(UnitRow.serial == unit)
        return self._session.scalar(query.where(SessionRow.state.in_(states)).limit(1)) is not None

    def wanted(self, query: SessionQuery) -> tuple[StoredSession, ...]:
        """The wanted sessions in the wanted order; one more query where the list goes on from a session."""
        page = SESSIONS.page(self._session, session_rows(), query)
        return page.forward(session_record(*row) for row in self._session.execute(page.cut(session_rows())))

    def block(self, id: str) -> str:
        """The kind of the block that a session measured."""
        return self._session.execute(select(SessionRow.block).where(SessionRow.id == id)).scalar_one()

    def reference(self, unit: int, block: str, at: datetime, programmes: tuple[str, ...] = CALIBRATIONS) -> str | None:
        """The session that others of the block and programmes, in the epoch of a time, are judged against."""
        return self._session.scalar(reference_query(unit, block, at, programmes))

    def of_readings(self, digest: str, but_unit: int, but: Collection[str]) -> StoredSession | None:
        """The first session of another unit that counts and has the same readings, other than ``but``."""
        same = SessionRow.readings_digest == digest, SessionRow.unit_id != but_unit, SessionRow.id.not_in(but)
        query = session_rows().where(*same, IS_ACCEPTED).order_by(SessionRow.uploaded_at, SessionRow.id).limit(1)
        found = self._session.execute(query).one_or_none()
        return None if found is None else session_record(*found)

    def add(self, record: StoredSession, unit: int, stand: int | None, block: str, digests: Digests) -> None:
        """Stores a session that is still to be judged; its hash is unique."""
        values = asdict(record)
        del values["unit"], values["stand"], values["reservations"]
        more = {"unit_id": unit, "stand_id": stand, "block": block, **asdict(digests), "basis": NOT_JUDGED}
        more["utc_offset"] = offset_minutes(record.started_at)
        self.insert_many(SessionRow, ({**values, **more},))

    def mark(self, id: str, **said: bool | str | None) -> None:
        """Writes marks and statements on a session."""
        self._session.execute(update(SessionRow).where(SessionRow.id == id).values(**said))
        self._session.expire_all()

    def of_unit(self, serial: str) -> tuple[StoredSession, ...]:
        """All sessions of a unit, oldest first."""
        query = session_rows().where(UnitRow.serial == serial).order_by(SessionRow.started_at, SessionRow.id)
        return tuple(session_record(*found) for found in self._session.execute(query))

    def latest_like(self, serial: str | None, unit_type: str | None) -> StoredSession | None:
        """The last accepted session of a unit, or of a type's units, calibrations first; of all units with neither."""
        query = session_rows().where(IS_ACCEPTED)
        if serial is not None:
            query = query.where(UnitRow.serial == serial)
        if unit_type is not None:
            of_type = select(UnitTypeRow.id).where(UnitTypeRow.name == unit_type).scalar_subquery()
            query = query.where(UnitRow.unit_type_id == of_type)
        calibrates = SessionRow.programme.in_(CALIBRATIONS)
        found = self._session.execute(
            query.order_by(calibrates.desc(), SessionRow.started_at.desc(), SessionRow.id).limit(1)
        ).first()
        return None if found is None else session_record(*found)

    def before(self, session: StoredSession, since: datetime | None, most: int) -> tuple[StoredSession, ...]:
        """The last sessions of the unit's same programme before one and not before a time, oldest first."""
        query = session_rows().where(
            UnitRow.serial == session.unit,
            SessionRow.programme == session.programme,
            SessionRow.started_at < session.started_at,
            IS_ACCEPTED,
        )
        if since is not None:
            query = query.where(SessionRow.started_at >= since)
        latest = query.order_by(SessionRow.started_at.desc(), SessionRow.id.desc()).limit(most)
        return tuple(session_record(*found) for found in self._session.execute(latest))[::-1]

    def corrected(self, session: StoredSession) -> tuple[str, ...]:
        """Sessions, accepted or questioned, that were uploaded later than one, of the same unit, programme and date."""
        query = session_rows().where(
            UnitRow.serial == session.unit,
            SessionRow.programme == session.programme,
            SessionRow.started_at == session.started_at,
            SessionRow.uploaded_at >= session.uploaded_at,
            SessionRow.id != session.id,
            SessionRow.state.in_((RecordState.ACCEPTED, RecordState.QUESTIONED)),
        )
        return tuple(row.id for row, *_ in self._session.execute(query.order_by(SessionRow.id)))

    def without_diagnosis(self, after: str, limit: int, version: str) -> tuple[str, ...]:
        """Ids of sessions, from an id on, that were never diagnosed, or on which another version failed."""
        query = (
            select(SessionRow.id)
            .outerjoin(DiagnosisRow, DiagnosisRow.session_id == SessionRow.id)
            .where(
                or_(
                    DiagnosisRow.session_id.is_(None),
                    and_(DiagnosisRow.state == DiagnosisState.FAILED, DiagnosisRow.estimator_version != version),
                ),
                SessionRow.id > after,
            )
        )
        return tuple(self._session.scalars(query.order_by(SessionRow.id).limit(limit)))

    def motions(self, id: str) -> tuple[CommonMotion, ...]:
        """The common motions of a session under the revision in force."""
        rows = self._session.scalars(
            select(CommonMotionRow)
            .join(SessionRow, SessionRow.id == CommonMotionRow.session_id)
            .where(CommonMotionRow.session_id == id, CommonMotionRow.revision == SessionRow.revision)
            .order_by(CommonMotionRow.kind, CommonMotionRow.quantity)
        )
        return tuple(motion_record(row) for row in rows)

    def decisions(self, id: str) -> tuple[Decision, ...]:
        """The decisions on a session's parameters under the revision in force, in the order of its sensors."""
        rows = self._session.scalars(
            select(DecisionRow)
            .join(SessionRow, SessionRow.id == DecisionRow.session_id)
            .where(DecisionRow.session_id == id, DecisionRow.revision == SessionRow.revision)
            .order_by(DecisionRow.position)
        )
        return tuple(decision_record(row) for row in rows)

    def achieved(self, unit_type: str) -> tuple[Achieved, ...]:
        """The changes in the latest accepted sessions of a type, each parameter of each sensor one."""
        row = DecisionRow
        query = (
            select(row.kind, row.parameter, row.deviation, row.expanded, row.tolerance)
            .join(SessionRow, (SessionRow.id == row.session_id) & (SessionRow.revision == row.revision))
            .join(UnitRow, UnitRow.id == SessionRow.unit_id)
            .join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
            .where(UnitTypeRow.name == unit_type, IS_ACCEPTED, SessionRow.programme.in_(CALIBRATIONS))
            .order_by(SessionRow.started_at.desc(), SessionRow.id, row.position)
            .limit(MOST_ACHIEVED)
        )
        return tuple(Achieved(*found) for found in self._session.execute(query))

    def temperature_steps(self, ids: Collection[str]) -> dict[str, Steps]:
        """The corrections for temperature of sessions, by session; without those that have none."""
        row, taken = DecisionRow, DecisionRow.temperature_correction
        query = select(row.session_id, row.sensor, row.parameter, taken).join(
            SessionRow, (SessionRow.id == row.session_id) & (SessionRow.revision == row.revision)
        )
        found: dict[str, dict[tuple[str, str], TemperatureCorrection]] = {}
        rows = self._session.execute(query.where(row.session_id.in_(tuple(ids)), taken.is_not(None)))
        for id, sensor, parameter, document in rows:
            found.setdefault(id, {})[sensor, parameter] = TemperatureCorrection(**(document or {}))
        return {**found}

    def judged(self, id: str) -> tuple[tuple[Decision, ...], tuple[CommonMotion, ...]]:
        """Both, in one query."""
        listed, revision = lists("decisions", "motions"), SessionRow.revision
        decided = (DecisionRow.session_id == SessionRow.id) & (DecisionRow.revision == revision)
        moved = (CommonMotionRow.session_id == SessionRow.id) & (CommonMotionRow.revision == revision)
        query = (
            select(DecisionRow, CommonMotionRow)
            .select_from(listed)
            .join(SessionRow, SessionRow.id == id)
            .outerjoin(DecisionRow, (listed.c.list == "decisions") & decided)
            .outerjoin(CommonMotionRow, (listed.c.list == "motions") & moved)
            .order_by(DecisionRow.position, CommonMotionRow.kind, CommonMotionRow.quantity)
        )
        rows = self._session.execute(query).all()
        decisions = tuple(decision_record(row) for row, _ in rows if row is not None)
        return decisions, tuple(motion_record(row) for _, row in rows if row is not None)


_Reference = aliased(SessionRow)
"""A session that others are judged against."""


def reference_query(
    unit: int | SQLColumnExpression[int],
    block: str | SQLColumnExpression[str],
    at: datetime,
    programmes: tuple[str, ...] = CALIBRATIONS,
) -> Select[str]:
    """The id of the session that others of the block and programmes, in the epoch of a time, are judged against."""
    since, until = epoch_bounds(unit, at)
    row = _Reference
    conditions = (row.unit_id == unit, row.block == block, row.programme.in_(programmes), row.is_reference)
    query = select(row.id).where(
        *conditions,
        row.state == RecordState.ACCEPTED,
        or_(since.is_(None), row.started_at >= since),
        or_(until.is_(None), row.started_at < until),
    )
    return query.order_by(row.started_at, row.id).limit(1)


def epoch_bounds(
    unit: int | SQLColumnExpression[int], at: datetime
) -> tuple[ScalarSelect[datetime], ScalarSelect[datetime]]:
    """The last break of a unit at or before a time and the first one after it, null where there is none."""
    first, last, known = func.min(ServiceRow.at), func.max(ServiceRow.at), (ServiceRow.unit_id == unit, IS_BREAK)
    since = select(last).where(*known, ServiceRow.at <= at)
    until = select(first).where(*known, ServiceRow.at > at)
    return since.correlate(UnitRow).scalar_subquery(), until.correlate(UnitRow).scalar_subquery()


def worst_columns(worst: Decision | None) -> dict[str, str | float | None]:
    """The columns of the decision that sets a verdict, stored beside the verdict."""
    if worst is None:
        return {"worst_sensor": None, "worst_parameter": None, "margin": None}
    return {"worst_sensor": worst.sensor, "worst_parameter": worst.parameter, "margin": worst.margin}


def session_rows() -> Select[SessionRow, str, str, str | None, list[Any] | None]:
    """Sessions with what their records hold besides."""
    return (
        select(SessionRow, UnitRow.serial, StandRow.name, DiagnosisRow.session_id, DiagnosisRow.reservations)
        .join(UnitRow, UnitRow.id == SessionRow.unit_id)
        .outerjoin(StandRow, StandRow.id == SessionRow.stand_id)
        .outerjoin(DiagnosisRow, DiagnosisRow.session_id == SessionRow.id)
    )


_BY_ID = session_rows().where(SessionRow.id == bindparam("id"))
_BY_HASH = session_rows().where(SessionRow.sha256 == bindparam("sha256"))
_SAME = session_rows().where(
    (SessionRow.sha256 == bindparam("sha256")) | (SessionRow.content_digest == bindparam("digest"))
)


def session_record(
    row: SessionRow, unit: str, stand: str | None, diagnosed: str | None, reservations: list[Any] | None
) -> StoredSession:
    """A stored session, of a row of `session_rows`."""
    said_with = reservations_from_list(diagnosed, reservations)
    at = local(row.started_at, row.utc_offset)
    return copied(StoredSession, row, unit=unit, stand=stand, started_at=at, reservations=said_with)


def decision_record(row: DecisionRow) -> Decision:
    """A stored decision."""
    values = {f.name: _plain(getattr(row, f.name)) for f in fields(Decision)}
    taken = row.temperature_correction
    values["temperature_correction"] = None if taken is None else TemperatureCorrection(**taken)
    return Decision(**values | {"verdict": Verdict(row.verdict)})


def motion_record(row: CommonMotionRow) -> CommonMotion:
    """A stored common motion."""
    return CommonMotion(**{f.name: _plain(getattr(row, f.name)) for f in fields(CommonMotion)})


def _plain(value: Any) -> Any:
    return tuple(map(_plain, value)) if isinstance(value, list) else value


SEVERITY = case({verdict.value: verdict.severity for verdict in Verdict}, value=SessionRow.verdict)
"""A number that orders verdicts from good to bad."""
LATEST = (Key(SessionRow.started_at, is_falling=True), Key(SessionRow.id, is_falling=True))
ORDERS = {
    SessionOrder.MEASURED: LATEST,
    SessionOrder.UPLOADED: (Key(SessionRow.uploaded_at, is_falling=True), Key(SessionRow.id, is_falling=True)),
    SessionOrder.VERDICT: (Key(SEVERITY, is_falling=True), *LATEST),
    SessionOrder.UNIT: (Key(UnitRow.serial), Key(SessionRow.started_at), Key(SessionRow.id)),
}


def _is_of(name: str) -> ColumnElement[bool]:
    of_type = select(UnitTypeRow.id).where(UnitTypeRow.name == name)
    return UnitRow.unit_type_id == of_type.scalar_subquery()


def _is_on(stand: str) -> ColumnElement[bool]:
    return SessionRow.stand_id == select(StandRow.id).where(StandRow.name == stand).scalar_subquery()


SESSIONS: Listing[SessionQuery] = Listing(
    name=SessionRow.id,
    keys=lambda wanted: ORDERS[wanted.order],
    conditions={
        "text": lambda text: UnitRow.serial.icontains(text, autoescape=True),
        "unit": lambda serial: UnitRow.serial == serial,
        "unit_type": _is_of,
        "stand": _is_on,
        "since": lambda since: SessionRow.started_at >= since,
        "until": lambda until: SessionRow.started_at < until,
        "state": lambda state: SessionRow.state == state,
        "verdict": lambda verdict: SessionRow.verdict == verdict,
        "is_reference": lambda is_so: SessionRow.is_reference.is_(is_so),
        "reserved": lambda _: DiagnosisRow.reservations.is_not(None),
    },
)


def reservations_to_list(reservations: Sequence[Reservation]) -> list[Json] | None:
    """The reservations as they are stored, or None where there are none."""
    return STORED.written(list(reservations)) or None


def reservations_from_list(diagnosed: str | None, entries: list[Any] | None) -> Reservations:
    """Reads the output of `reservations_to_list`; None where no diagnosis is stored yet."""
    return None if diagnosed is None else tuple(STORED.read(Reservation, entry) for entry in entries or ())
