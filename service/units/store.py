"""Units by serial number, their services, and the register: location and custodian of each."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from datetime import datetime

from sqlalchemy import Select, exists, select, update

from service.errors import NotFoundError
from service.kit.copying import copied
from service.queue.subjects_store import ASKED, has_demonstration
from service.sessions.states import RecordState
from service.sessions.states_store import IS_ACCEPTED, IS_BREAK
from service.sessions.tables import SessionRow
from service.stands.tables import StandRow
from service.storage.queries import Queries
from service.types.tables import UnitTypeRow
from service.units.records import Custody, CustodyStep, Customer, Move, NewEntry, NewService, Registered, Service
from service.units.tables import CustodyRow, ServiceRow, UnitRow

HAS_SESSION = exists().where(SessionRow.unit_id == UnitRow.id)
"""Whether a session of a unit was ever stored, whatever became of it."""


class Units(Queries):
    """Units by serial number."""

    def exists(self, serial: str) -> bool:
        """Whether a session of this unit was ever stored."""
        return self.find(serial) is not None

    def is_simulated(self, serial: str) -> bool | None:
        """Whether a unit's sessions are simulated, as its first one was; None without a session."""
        if ("simulated", serial) in self._session.info:
            return bool(self._session.info["simulated", serial])
        return self._session.scalar(select(UnitRow.simulated).where(UnitRow.serial == serial, HAS_SESSION))

    def set_simulated(self, serial: str, simulated: bool) -> None:
        """Records whether a unit's sessions are simulated or measured from now on."""
        statement = update(UnitRow).where(UnitRow.serial == serial, UnitRow.simulated.is_not(simulated))
        self._session.execute(statement.values(simulated=simulated))
        self._session.info.pop(("simulated", serial), None)

    def set_type(self, unit: int, name: str) -> None:
        """Records the type of a unit from now on."""
        type_id = select(UnitTypeRow.id).where(UnitTypeRow.name == name).scalar_subquery()
        self._session.execute(update(UnitRow).where(UnitRow.id == unit).values(unit_type_id=type_id))
        self.touch(unit)

    def set_lot(self, serial: str, lot: str | None) -> str | None:
        """Records a unit's production lot, and returns the one before."""
        unit = self._session.scalars(select(UnitRow).where(UnitRow.serial == serial)).one()
        previous, unit.lot = unit.lot, lot
        self._session.flush()
        return previous

    def customer(self, serial: str) -> Customer:
        """The customer for whom a unit is calibrated."""
        row = self._session.execute(
            select(UnitRow.customer, UnitRow.customer_address).where(UnitRow.serial == serial)
        ).one_or_none()
        if row is None:
            raise NotFoundError("There is no unit {serial}.", serial=repr(serial))
        return Customer(*row)

    def set_customer(self, serial: str, new: Customer) -> None:
        """Records for whom a unit is calibrated."""
        unit = self._session.scalars(select(UnitRow).where(UnitRow.serial == serial)).one()
        unit.customer, unit.customer_address = new.name, new.address
        self._session.flush()

    def of_type(self, name: str) -> tuple[str, ...]:
        """Serial numbers of a type's units, in order."""
        query = select(UnitRow.serial).join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
        return tuple(self._session.scalars(query.where(UnitTypeRow.name == name).order_by(UnitRow.serial)))

    def every(self) -> tuple[str, ...]:
        """Serial numbers of all units, in order."""
        return tuple(self._session.scalars(select(UnitRow.serial).order_by(UnitRow.serial)))

    def accepted(self, *, simulated: bool) -> tuple[tuple[str, str], ...]:
        """Serial number and type of every unit, measured or simulated, with a session that counts."""
        has_session = exists().where(SessionRow.unit_id == UnitRow.id, IS_ACCEPTED)
        query = select(UnitRow.serial, UnitTypeRow.name).join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
        rows = self._session.execute(query.where(has_session, UnitRow.simulated.is_(simulated)).order_by(UnitRow.id))
        return tuple((serial, kind) for serial, kind in rows)

    def add_once(self, serial: str, unit_type: str, simulated: bool) -> None:
        """Stores a new unit; one of that serial number that is there already stays as it is."""
        type_id = select(UnitTypeRow.id).where(UnitTypeRow.name == unit_type).scalar_subquery()
        self.insert_once(UnitRow, serial=serial, unit_type_id=type_id, simulated=simulated)

    def begin(self, serial: str, unit_type: str, simulated: bool, *, is_demonstration: bool = False) -> None:
        """A unit that was only registered until now is of the type and the origin of its first session."""
        type_id = select(UnitTypeRow.id).where(UnitTypeRow.name == unit_type).scalar_subquery()
        unmeasured = update(UnitRow).where(UnitRow.serial == serial, ~HAS_SESSION)
        first = unmeasured.values(unit_type_id=type_id, simulated=simulated, is_demonstration=is_demonstration)
        self._session.execute(first)
        self._session.info.pop(("simulated", serial), None)
        self._session.info.pop(ASKED, None)

    def set_own(self, serial: str) -> None:
        """Records that somebody uploads a session of a unit, which is not of the demonstration alone any more."""
        if has_demonstration(self._session):
            statement = update(UnitRow).where(UnitRow.serial == serial, UnitRow.is_demonstration)
            self._session.execute(statement.values(is_demonstration=False))
            self._session.info.pop(ASKED)

    def held(self, serial: str) -> int | None:
        """The key of a unit that is there, with the unit held until the transaction ends: its sessions are judged one
        after another."""
        info = self._session.info
        if ("held", serial) not in info:
            query = select(UnitRow.id, UnitRow.simulated).where(UnitRow.serial == serial).with_for_update()
            row = self._session.execute(query).one_or_none()
            if row is None:
                return None
            info["held", serial], info["simulated", serial] = row
            self.remember_unit(serial, row[0])
        key: int = info["held", serial]
        return key

    def hold(self, serial: str) -> int:
        """The key of a unit, held until the transaction ends; NotFoundError where there is none."""
        key = self.held(serial)
        if key is None:
            raise NotFoundError("There is no unit {serial}.", serial=repr(serial))
        return key

    def find(self, serial: str) -> int | None:
        """The key of a unit; None without a session."""
        return self._session.scalar(select(UnitRow.id).where(UnitRow.serial == serial, HAS_SESSION))

    def key(self, serial: str) -> int:
        """The unit's key, which never changes: asked for once a transaction."""
        known = self.remembered_unit(serial)
        if known is not None:
            return known
        key = self._session.scalar(select(UnitRow.id).where(UnitRow.serial == serial))
        if key is None:
            raise NotFoundError("There is no unit {serial}.", serial=repr(serial))
        self.remember_unit(serial, key)
        return key

    def stand_key(self, name: str | None) -> int | None:
        """The key of a stand, stored when it is new; None without a stand."""
        if name is None:
            return None
        query = select(StandRow.id).where(StandRow.name == name)
        key = self._session.scalar(query)
        if key is None:
            self.insert_once(StandRow, name=name)
            key = self._session.scalar(query)
        return key


class Services(Queries):
    """Adjustments, repairs, sensor swaps, new references."""

    def add(self, unit: int, new: NewService, now: datetime) -> tuple[int, bool]:
        """Records a break and returns its number and whether it is new; the same break twice is one."""
        created = self.insert_once(ServiceRow, unit_id=unit, recorded_at=now, **asdict(new))
        row = self._session.scalars(
            select(ServiceRow).where(
                ServiceRow.unit_id == unit,
                ServiceRow.at == new.at,
                ServiceRow.kind == new.kind,
                ServiceRow.sensor == new.sensor,
            )
        ).one()
        return row.id, created

    def get(self, number: int) -> Service:
        """One recorded break."""
        row = self._session.execute(_services().where(ServiceRow.id == number)).one_or_none()
        if row is None:
            raise NotFoundError("There is no service {number}.", number=number)
        return service_record(*row)

    def put_state(self, number: int, state: RecordState) -> None:
        """Whether it counts as a break."""
        self._session.execute(update(ServiceRow).where(ServiceRow.id == number).values(state=state))
        self._session.expire_all()

    def of_unit(self, serial: str) -> tuple[Service, ...]:
        """The breaks of a unit, oldest first."""
        return tuple(s for s in self.recorded(serial) if s.state is RecordState.ACCEPTED)

    def recorded(self, serial: str) -> tuple[Service, ...]:
        """All services of a unit, those that were withdrawn too, oldest first."""
        query = _services().where(UnitRow.serial == serial).order_by(ServiceRow.at, ServiceRow.id)
        return tuple(service_record(row, owner) for row, owner in self._session.execute(query))

    def breaks(self, unit: int) -> tuple[datetime, ...]:
        """The beginnings of a unit's epochs, its first one apart, in order."""
        query = select(ServiceRow.at).where(ServiceRow.unit_id == unit, IS_BREAK)
        return tuple(sorted(set(self._session.scalars(query))))

    def began(self, unit: int, at: datetime) -> datetime | None:
        """The last break at or before a time, with which the epoch that the time is in began."""
        return epoch(self.breaks(unit), at)[0]


def epoch(breaks: tuple[datetime, ...], at: datetime) -> tuple[datetime | None, datetime | None]:
    """The last of the breaks at or before a time and the first one after it."""
    before, after = [b for b in breaks if b <= at], [b for b in breaks if b > at]
    return max(before, default=None), min(after, default=None)


def _services() -> Select[ServiceRow, str]:
    return select(ServiceRow, UnitRow.serial).join(UnitRow, UnitRow.id == ServiceRow.unit_id)


def service_record(row: ServiceRow, serial: str) -> Service:
    """A stored break."""
    return copied(Service, row, unit=serial)


class Register(Queries):
    """Entries by serial number."""

    def get(self, serial: str) -> Registered:
        """The entry of one unit; NotFoundError where there is none."""
        found = self.find((serial,))
        if not found:
            raise NotFoundError("There is no unit {serial}.", serial=repr(serial))
        return found[serial]

    def find(self, serials: Sequence[str]) -> dict[str, Registered]:
        """The entries of the units that exist among some, by serial number."""
        rows = self._session.execute(_entries().where(UnitRow.serial.in_(serials)))
        return {row.serial: register_entry(row, unit_type) for row, unit_type in rows}

    def every(self) -> tuple[Registered, ...]:
        """All units, retired ones too, by serial number."""
        rows = self._session.execute(_entries().order_by(UnitRow.serial))
        return tuple(register_entry(row, unit_type) for row, unit_type in rows)

    def measured(self, serials: Sequence[str]) -> frozenset[str]:
        """The units among some for which a session was ever stored."""
        return frozenset(self._session.scalars(select(UnitRow.serial).where(UnitRow.serial.in_(serials), HAS_SESSION)))

    def put(self, unit: int, new: NewEntry, now: datetime) -> None:
        """Writes the entry of a unit; from now on it is in the register."""
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
        """Locations and custodians of a unit, the latest first."""
        query = select(CustodyRow).join(UnitRow, UnitRow.id == CustodyRow.unit_id).where(UnitRow.serial == serial)
        rows = self._session.scalars(query.order_by(CustodyRow.at.desc(), CustodyRow.id.desc()))
        return tuple(_line(row, serial) for row in rows)


def _entries() -> Select[UnitRow, str]:
    return select(UnitRow, UnitTypeRow.name).join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)


def register_entry(row: UnitRow, unit_type: str) -> Registered:
    """The entry from a unit's row."""
    return copied(Registered, row, unit=row.serial, unit_type=unit_type, note=row.remark)


def _line(row: CustodyRow, serial: str) -> Custody:
    names = ("id", "at", "who", "location_before", "location", "custodian_before", "custodian", "remark", "recorded_at")
    return Custody(unit=serial, step=CustodyStep(row.step), **{name: getattr(row, name) for name in names})
