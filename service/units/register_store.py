"""The register of units: whose they are, where they are, who has them, and how that came about."""

from collections.abc import Mapping, Sequence
from datetime import datetime

from sqlalchemy import Select, select, update

from service.errors import NotFoundError
from service.kit.copying import copied
from service.storage.queries import Queries
from service.types.tables import UnitTypeRow
from service.units.records import Custody, CustodyStep, Move, NewEntry, Registered
from service.units.store import HAS_SESSION
from service.units.tables import CustodyRow, UnitRow


class Register(Queries):
    """Entries by serial number."""

    def get(self, serial: str) -> Registered:
        """What is known of one unit."""
        found = self.find((serial,))
        if not found:
            raise NotFoundError("There is no unit {serial}.", serial=repr(serial))
        return found[serial]

    def find(self, serials: Sequence[str]) -> dict[str, Registered]:
        """The same of those of some units that there are, by serial number."""
        rows = self._session.execute(_entries().where(UnitRow.serial.in_(serials)))
        return {row.serial: register_entry(row, unit_type) for row, unit_type in rows}

    def every(self) -> tuple[Registered, ...]:
        """All units, retired ones too, by serial number."""
        rows = self._session.execute(_entries().order_by(UnitRow.serial))
        return tuple(register_entry(row, unit_type) for row, unit_type in rows)

    def measured(self, serials: Sequence[str]) -> frozenset[str]:
        """Those of some units of which a session was ever stored."""
        return frozenset(self._session.scalars(select(UnitRow.serial).where(UnitRow.serial.in_(serials), HAS_SESSION)))

    def put(self, unit: int, new: NewEntry, now: datetime) -> None:
        """Writes what is stated of a unit; from now on it is in the register."""
        self._write(unit, new.stated)
        entered = update(UnitRow).where(UnitRow.id == unit, UnitRow.registered_at.is_(None))
        self._session.execute(entered.values(registered_at=now))

    def move(self, unit: int, move: Move) -> None:
        """Writes where a unit is and who has it."""
        known = {"location": move.location, "custodian": move.custodian}
        self._write(unit, {name: value for name, value in known.items() if value is not None})

    def retire(self, unit: int, at: datetime | None) -> None:
        """Writes since when a unit is retired; None puts it back into use."""
        self._session.execute(update(UnitRow).where(UnitRow.id == unit).values(retired_at=at))

    def _write(self, unit: int, values: Mapping[str, str]) -> None:
        if values:
            self._session.execute(update(UnitRow).where(UnitRow.id == unit).values(**values))
        self.touch(unit)

    def add(self, unit: int, was: Registered | None, move: Move, at: datetime, who: str, now: datetime) -> None:
        """Stores one line of a unit's history."""
        before = ("", "") if was is None else (was.location, was.custodian)
        location, custodian = (
            old if new is None else new for old, new in zip(before, (move.location, move.custodian), strict=True)
        )
        self._session.add(
            CustodyRow(
                unit_id=unit, at=at, recorded_at=now, who=who, step=move.step, location_before=before[0],
                location=location, custodian_before=before[1], custodian=custodian, remark=move.remark,
            )
        )  # fmt: skip
        self._session.flush()

    def history(self, serial: str) -> tuple[Custody, ...]:
        """Where a unit was and who had it, the latest first."""
        query = select(CustodyRow).join(UnitRow, UnitRow.id == CustodyRow.unit_id).where(UnitRow.serial == serial)
        rows = self._session.scalars(query.order_by(CustodyRow.at.desc(), CustodyRow.id.desc()))
        return tuple(_line(row, serial) for row in rows)


def _entries() -> Select[UnitRow, str]:
    return select(UnitRow, UnitTypeRow.name).join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)


def register_entry(row: UnitRow, unit_type: str) -> Registered:
    """What a unit's row says."""
    return copied(Registered, row, unit=row.serial, unit_type=unit_type, note=row.remark)


def _line(row: CustodyRow, serial: str) -> Custody:
    names = ("id", "at", "who", "location_before", "location", "custodian_before", "custodian", "remark", "recorded_at")
    return Custody(unit=serial, step=CustodyStep(row.step), **{name: getattr(row, name) for name in names})
