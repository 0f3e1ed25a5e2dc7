"""Unit types and the revisions of their tolerances."""

from collections.abc import Mapping
from dataclasses import asdict
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, Select, bindparam, func, or_, select, update
from sqlalchemy.orm import aliased

from estimator.health.type_law import TypeLaw
from estimator.session import CALIBRATIONS
from service.errors import NotFoundError
from service.fleet.tables import FleetTallyRow
from service.sessions.decision import Verdict
from service.sessions.states_store import IS_ACCEPTED
from service.sessions.tables import ParameterRow, SessionRow
from service.storage.json_text import STORED
from service.storage.queries import Queries
from service.types.records import ToleranceRevision, Tolerances, TypeUse, UnitType
from service.types.tables import ToleranceRow, UnitTypeRow
from service.units.tables import UnitRow

TypeThroughTime = tuple[tuple[datetime, UnitType], ...]
"""A type with every revision of its tolerances and its start; oldest first."""


class UnitTypes(Queries):
    """Kinds of unit and their tolerances."""

    def add_once(self, unit_type: UnitType, now: datetime) -> None:
        """Stores a new type; one of that name that is there already stays as it is, unless only its name is known."""
        block = {
            "block": unit_type.block,
            "sensors": list(unit_type.sensors),
            "nominal_axes": [list(axis) for axis in unit_type.nominal_axes],
            "nominal_scales": list(unit_type.nominal_scales),
        }
        added = self.insert_once(
            UnitTypeRow,
            name=unit_type.name,
            revision=unit_type.revision,
            maximum_interval_days=unit_type.maximum_interval_days,
            flag_share=unit_type.flag_share,
            **block,
        )
        if added:
            self._add_tolerances(self._row(unit_type.name), unit_type, now)
        elif self._complete(unit_type.name, block):
            self._set_first(unit_type)

    def _complete(self, name: str, block: Mapping[str, Any]) -> bool:
        """Completes a type that only had a name from its first session; whether it did."""
        named = update(UnitTypeRow).where(UnitTypeRow.name == name, UnitTypeRow.block == "")
        return bool(self._session.scalars(named.values(**block).returning(UnitTypeRow.id)).all())

    def _set_first(self, unit_type: UnitType) -> None:
        """Sets the first tolerances of a type that only had a name, by which nothing was judged."""
        first = self._session.get_one(ToleranceRow, (self._row(unit_type.name).id, 1))
        gyro = unit_type.gyro_tolerances
        first.tolerances, first.gyro_tolerances = asdict(unit_type.tolerances), None if gyro is None else asdict(gyro)
        self._session.flush()

    def get(self, name: str) -> UnitType:
        """The type with its current tolerances."""
        unit_type = self.find(name)
        if unit_type is None:
            raise _missing(name)
        return unit_type

    def find(self, name: str) -> UnitType | None:
        """The type of a name; None where there is none."""
        row = self._session.execute(_with_tolerances().where(UnitTypeRow.name == name)).one_or_none()
        return None if row is None else unit_type_of(*row)

    def of_unit(self, serial: str) -> UnitType:
        """The type of a unit with its current tolerances."""
        row = self._session.execute(
            _with_tolerances().join(UnitRow, UnitRow.unit_type_id == UnitTypeRow.id).where(UnitRow.serial == serial)
        ).one_or_none()
        if row is None:
            raise NotFoundError("There is no unit {serial}.", serial=repr(serial))
        return unit_type_of(*row)

    def of_unit_through_time(self, serial: str) -> TypeThroughTime:
        """The type of a unit with every revision of its tolerances, oldest first."""
        rows = self._session.execute(_THROUGH_TIME, {"serial": serial})
        return tuple((tolerances.since, unit_type_of(row, tolerances)) for row, tolerances in rows)

    def page(self, offset: int, limit: int) -> tuple[UnitType, ...]:
        """Types by name."""
        rows = self._session.execute(_with_tolerances().order_by(UnitTypeRow.name).offset(offset).limit(limit))
        return tuple(unit_type_of(row, tolerances) for row, tolerances in rows)

    def revisions(self, name: str) -> tuple[ToleranceRevision, ...]:
        """Every revision of a type's tolerances, oldest first."""
        query = select(ToleranceRow).join(UnitTypeRow).where(UnitTypeRow.name == name).order_by(ToleranceRow.revision)
        return tuple(
            ToleranceRevision(row.revision, row.since, *_tolerances(row), _laws(row), row.are_entered)
            for row in self._session.scalars(query)
        )

    def uses(self, name: str | None = None) -> dict[str, TypeUse]:
        """Units of every type, or of one, by condition, in one query."""
        row = FleetTallyRow
        query = (
            select(UnitTypeRow.name, row.severity, func.coalesce(func.sum(row.units), 0))
            .outerjoin(row, row.unit_type_id == UnitTypeRow.id)
            .group_by(UnitTypeRow.name, row.severity)
        )
        if name is not None:
            query = query.where(UnitTypeRow.name == name)
        found: dict[str, dict[int | None, int]] = {}
        for of_type, severity, count in self._session.execute(query):
            found.setdefault(of_type, {})[severity] = count
        return {of_type: _use(counts) for of_type, counts in found.items()}

    def kinds(self, name: str) -> dict[str, str]:
        """The kind of every sensor in the latest calibration of a unit of the type."""
        return self._kinds(UnitTypeRow.name == name)

    def kinds_of_unit(self, serial: str) -> dict[str, str]:
        """The kind of every sensor in the latest calibration of a unit."""
        return self._kinds(UnitRow.serial == serial)

    def alike(self, known: UnitType) -> tuple[str, ...]:
        """Names of the other types with as many sensors of the same kinds."""
        query = select(UnitTypeRow.name, UnitTypeRow.sensors).where(UnitTypeRow.block == known.block)
        rows = self._session.execute(query.order_by(UnitTypeRow.name))
        return tuple(name for name, sensors in rows if len(sensors) == len(known.sensors) and name != known.name)

    def _kinds(self, condition: ColumnElement[bool]) -> dict[str, str]:
        latest = (
            select(SessionRow.id)
            .join(UnitRow, UnitRow.id == SessionRow.unit_id)
            .join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
            .where(condition, IS_ACCEPTED, SessionRow.programme.in_(CALIBRATIONS))
            .order_by(SessionRow.started_at.desc(), SessionRow.id)
            .limit(1)
        )
        query = select(ParameterRow.sensor, ParameterRow.kind).where(
            ParameterRow.session_id == latest.scalar_subquery()
        )
        return {sensor: kind for sensor, kind in self._session.execute(query.distinct())}  # noqa: C416 - rows are no pairs

    def hold(self, name: str) -> UnitType:
        """The type, locked until the transaction ends: its revisions are made one after another."""
        row = self._session.scalar(select(UnitTypeRow).where(UnitTypeRow.name == name).with_for_update())
        if row is None:
            raise _missing(name)
        return self._record(row)

    def set_watch(self, name: str, *, days: float, share: float) -> UnitType:
        """Another longest interval, and another part of the tolerance from which on a change has a flag."""
        row = self._row(name)
        row.maximum_interval_days, row.flag_share = days, share
        self._session.flush()
        return self._record(row)

    def revise(
        self,
        wanted: UnitType,
        now: datetime,
    ) -> UnitType:
        """Adds the next revision of a type's tolerances and temperature laws; earlier ones stay."""
        row = self._row(wanted.name)
        row.revision += 1
        self._add_tolerances(row, wanted, now)
        return self._record(row)

    def _add_tolerances(
        self,
        row: UnitTypeRow,
        wanted: UnitType,
        now: datetime,
    ) -> None:
        self._session.add(
            ToleranceRow(
                unit_type_id=row.id,
                revision=row.revision,
                since=now,
                tolerances=asdict(wanted.tolerances),
                gyro_tolerances=None if wanted.gyro_tolerances is None else asdict(wanted.gyro_tolerances),
                temperature_laws=[asdict(law) for law in wanted.temperature_laws] or None,
                are_entered=wanted.are_entered,
                holds_before=wanted.holds_before,
            )
        )
        self._session.flush()

    def _row(self, name: str) -> UnitTypeRow:
        row = self._session.scalar(select(UnitTypeRow).where(UnitTypeRow.name == name))
        if row is None:
            raise _missing(name)
        return row

    def _record(self, row: UnitTypeRow) -> UnitType:
        return unit_type_of(row, self._session.get_one(ToleranceRow, (row.id, row.revision)))


_THROUGH_TIME = (
    select(UnitTypeRow, ToleranceRow)
    .join(UnitRow, UnitRow.unit_type_id == UnitTypeRow.id)
    .join(ToleranceRow, ToleranceRow.unit_type_id == UnitTypeRow.id)
    .where(UnitRow.serial == bindparam("serial"))
    .order_by(ToleranceRow.revision)
)


def held_at(known: TypeThroughTime, at: datetime) -> UnitType:
    """The type with the tolerances that judge a session of a time: the last ones until then, or later ones that hold
    before; with its first ones where there are none.
    """
    return ([one for since, one in known if since <= at or one.holds_before] or [known[0][1]])[-1]


def _with_tolerances() -> Select[UnitTypeRow, ToleranceRow]:
    return select(UnitTypeRow, ToleranceRow).join(
        ToleranceRow, (ToleranceRow.unit_type_id == UnitTypeRow.id) & (ToleranceRow.revision == UnitTypeRow.revision)
    )


def _missing(name: str) -> NotFoundError:
    return NotFoundError("There is no unit type {name}.", name=repr(name))


def _use(counts: Mapping[int | None, int]) -> TypeUse:
    return TypeUse(sum(counts.values()), {verdict: counts.get(verdict.severity, 0) for verdict in Verdict})


def _tolerances(row: ToleranceRow) -> tuple[Tolerances, Tolerances | None]:
    """The tolerances of the block, and of the gyros of a mixed one."""
    gyro = row.gyro_tolerances
    return Tolerances(**row.tolerances), None if gyro is None else Tolerances(**gyro)


def _laws(row: ToleranceRow) -> tuple[TypeLaw, ...]:
    return tuple(STORED.read(TypeLaw, document) for document in row.temperature_laws or ())


def unit_type_of(row: UnitTypeRow, tolerances: ToleranceRow) -> UnitType:
    """The record of a type with one revision of its tolerances."""
    of_block, gyro = _tolerances(tolerances)
    return UnitType(
        name=row.name,
        block=row.block,
        sensors=tuple(row.sensors),
        nominal_axes=tuple(tuple(axis) for axis in row.nominal_axes),
        nominal_scales=tuple(row.nominal_scales),
        tolerances=of_block,
        gyro_tolerances=gyro,
        revision=tolerances.revision,
        maximum_interval_days=row.maximum_interval_days,
        flag_share=row.flag_share,
        temperature_laws=_laws(tolerances),
        are_entered=tolerances.are_entered,
        holds_before=tolerances.holds_before,
    )


def counts_for_type(unit_type: int) -> ColumnElement[bool]:
    """Units that count for the statistics of a type: measured ones, or simulated ones where there is no other."""
    other = aliased(UnitRow)
    measured = select(other.id).where(other.unit_type_id == unit_type, other.simulated.is_(False)).exists()
    return or_(UnitRow.simulated.is_(False), ~measured)


def counts_for_stand(stand: ColumnElement[int] | int) -> ColumnElement[bool]:
    """Sessions that count for the statistics of a stand: measured ones, or simulated ones where there is no other."""
    other = aliased(SessionRow)
    measured = select(other.id).where(other.stand_id == stand, other.simulated.is_(False)).exists()
    return or_(SessionRow.simulated.is_(False), ~measured)
