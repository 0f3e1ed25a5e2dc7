"""All facts that decide the permitted use of units, in one query for however many units."""

from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any

from sqlalchemy import ScalarSelect, Select, exists, func, or_, select
from sqlalchemy.orm import aliased

from estimator.session import CALIBRATIONS
from service.flags.records import Matter
from service.flags.tables import FlagRow
from service.fleet.condition import UnitSummary
from service.fleet.tables import ConditionRow, UseRow
from service.fleet.use import RANKS
from service.judging.records import OpenFlag, Usable, UseFacts
from service.judging.reference import left_uncertain
from service.kit.measures import COVERAGE
from service.models.records import Scope
from service.outlook.records import Action
from service.outlook.tables import OutlookRow
from service.queue.records import WorkKind
from service.queue.tables import WorkRow
from service.sessions.calibrations_store import calibration_of
from service.sessions.states import RecordState
from service.sessions.states_store import IS_BREAK
from service.sessions.store import is_waiting
from service.sessions.tables import CalibrationRow, SessionRow
from service.stands.store import certificate_record
from service.stands.tables import StandCertificateRow, StandRow
from service.storage.columns import RESOLVED
from service.storage.queries import Queries
from service.types.rules import tolerances_of
from service.types.store import unit_type_of
from service.types.tables import ToleranceRow, UnitTypeRow
from service.units.tables import ServiceRow, UnitRow

Other = aliased(SessionRow)
"""A session of the unit, beside its latest one."""
MATTERS = tuple(Matter)
Renewed = aliased(StandCertificateRow)
"""A later record of the same certificate."""


class UseStore(Queries):
    """Facts of units besides their summaries."""

    def facts(self, units: Sequence[UnitSummary], now: datetime) -> tuple[UseFacts, ...]:
        """The facts of units, in their order."""
        query = _facts(now).where(UnitRow.serial.in_([unit.serial for unit in units]))
        rows: dict[str, list[Sequence[Any]]] = {}
        for row in self._session.execute(query):
            rows.setdefault(row[0], []).append(row)
        return tuple(_record(unit, rows[unit.serial]) for unit in units)

    def touch_next(self, after: int, limit: int) -> int | None:
        """Marks the units that follow a key, so that they are settled; returns the last key, None after the last."""
        found = tuple(
            self._session.scalars(select(UnitRow.id).where(UnitRow.id > after).order_by(UnitRow.id).limit(limit))
        )
        self.touch(*found)
        return found[-1] if found else None

    def put(self, uses: Mapping[int, tuple[Usable, bool]]) -> None:
        """Rewrites the permitted use of units, by their keys, and whether the fleet lists them."""
        rows = [
            {"unit_id": unit, "answer": use.answer, "rank": RANKS[use.answer], "is_listed": listed, "use": str(use.use)}
            for unit, (use, listed) in uses.items()
        ]
        if rows:
            new = self._upsert(UseRow)
            kept = {name: getattr(new.excluded, name) for name in ("answer", "rank", "is_listed", "use")}
            self._session.execute(new.on_conflict_do_update(index_elements=["unit_id"], set_=kept), rows)


def _gravity(flag: OpenFlag) -> tuple[int, int, str]:
    """The gravest first, whichever was raised first."""
    return MATTERS.index(flag.matter), -flag.severity, flag.place


def _facts(now: datetime) -> Select[*tuple[Any, ...]]:
    """A row for each open flag of a unit, or one; the calibration of a session only where it is a reference, which may
    stand alone."""
    in_force = (ToleranceRow.unit_type_id == UnitTypeRow.id) & (ToleranceRow.revision == UnitTypeRow.revision)
    calibrated = (CalibrationRow.session_id == SessionRow.id) & (CalibrationRow.revision == SessionRow.revision)
    diagnosis = (WorkRow.kind == WorkKind.DIAGNOSIS) & (WorkRow.key == SessionRow.id)
    flags = (FlagRow.unit_id == UnitRow.id) & (FlagRow.scope == Scope.UNIT) & (FlagRow.state != RESOLVED)
    serviced = _serviced(now)
    return (
        select(
            UnitRow.serial, FlagRow, SessionRow.programme, SessionRow.started_at, StandRow.name, StandCertificateRow,
            is_waiting(SessionRow.basis), WorkRow.failed, serviced, _correction(serviced), _questioned(),
            OutlookRow.document["action"].as_string(), CalibrationRow.document, UnitTypeRow, ToleranceRow,
        )
        .join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
        .join(ToleranceRow, in_force)
        .outerjoin(ConditionRow, ConditionRow.unit_id == UnitRow.id)
        .outerjoin(SessionRow, SessionRow.id == ConditionRow.last_session)
        .outerjoin(StandRow, StandRow.id == SessionRow.stand_id)
        .outerjoin(StandCertificateRow, StandCertificateRow.id == _certificate())
        .outerjoin(FlagRow, flags)
        .outerjoin(WorkRow, diagnosis)
        .outerjoin(OutlookRow, OutlookRow.unit_id == UnitRow.id)
        .outerjoin(CalibrationRow, calibrated & SessionRow.is_reference)
    )  # fmt: skip


def _serviced(now: datetime) -> ScalarSelect[datetime]:
    conditions = (ServiceRow.unit_id == UnitRow.id, IS_BREAK, ServiceRow.at <= now)
    return select(func.max(ServiceRow.at)).where(*conditions).correlate(UnitRow).scalar_subquery()


def _correction(serviced: ScalarSelect[datetime]) -> ScalarSelect[str]:
    """The latest calibration of every sensor since then."""
    conditions = (Other.unit_id == UnitRow.id, Other.state == RecordState.ACCEPTED, Other.programme.in_(CALIBRATIONS))
    query = select(Other.id).where(*conditions, or_(serviced.is_(None), Other.started_at >= serviced))
    return query.order_by(Other.started_at.desc(), Other.id.desc()).limit(1).correlate(UnitRow).scalar_subquery()


def _questioned() -> ScalarSelect[datetime]:
    """The start of the latest session that waits for an engineer, of those after the one that counts."""
    later = or_(SessionRow.started_at.is_(None), Other.started_at > SessionRow.started_at)
    conditions = (Other.unit_id == UnitRow.id, Other.state == RecordState.QUESTIONED, later)
    return select(func.max(Other.started_at)).where(*conditions).correlate(UnitRow, SessionRow).scalar_subquery()


def _certificate() -> ScalarSelect[int]:
    """The latest certificate of the stand that was issued by the day of measurement."""
    row = StandCertificateRow
    renewed = exists().where(Renewed.stand_id == row.stand_id, Renewed.number == row.number, Renewed.id > row.id)
    conditions = (row.stand_id == SessionRow.stand_id, row.issued_on <= SessionRow.started_at, ~renewed)
    query = select(row.id).where(*conditions).order_by(row.issued_on.desc(), row.id.desc()).limit(1)
    return query.correlate(SessionRow).scalar_subquery()


def _record(unit: UnitSummary, rows: Sequence[Sequence[Any]]) -> UseFacts:
    programme, at, stand, held, waiting, failed, serviced, correction, questioned, action, document, *types = rows[0][
        2:
    ]
    return UseFacts(
        unit=unit,
        is_calibration=programme in CALIBRATIONS,
        serviced_at=serviced,
        action=None if action is None else Action(action),
        flags=tuple(sorted((_flag(row[1]) for row in rows if row[1] is not None), key=_gravity)),
        questioned_at=questioned,
        uncertain=() if document is None else _uncertain(document, *types),
        expired=None if held is None or held.valid_until >= at.date() else certificate_record(stand, held),
        not_diagnosed=failed or "",
        is_waiting=bool(waiting),
        correction=correction,
    )


def _flag(row: FlagRow) -> OpenFlag:
    return OpenFlag(row.id, Matter(row.matter), row.severity, row.place, row.summary)


def _uncertain(document: bytes, unit_type: UnitTypeRow, tolerances: ToleranceRow) -> tuple[str, ...]:
    """The parameters that a reference determines too poorly to be used by itself, by tolerances that were entered."""
    known = unit_type_of(unit_type, tolerances)
    if not known.are_entered:
        return ()
    return tuple(left_uncertain(calibration_of(document), tolerances_of(known), COVERAGE))
