"""Known breaks in units' histories."""

from dataclasses import asdict
from datetime import datetime

from sqlalchemy import Select, select, update

from service.errors import NotFoundError
from service.records.event import NewService, Service
from service.records.state import RecordState
from service.storage.queries.accepted import IS_BREAK
from service.storage.queries.base import Queries
from service.storage.tables import ServiceRow, UnitRow


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
        found = self._session.execute(_services().where(ServiceRow.id == number)).one_or_none()
        if found is None:
            raise NotFoundError(f"There is no service {number}.")
        return service_record(*found)

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
        """When the epochs of a unit begin, its first one apart, in order."""
        query = select(ServiceRow.at).where(ServiceRow.unit_id == unit, IS_BREAK)
        return tuple(sorted(set(self._session.scalars(query))))

    def around(self, unit: int, at: datetime) -> tuple[datetime | None, datetime | None]:
        """The last break at or before a time and the first one after it: the epoch that the time is in."""
        return epoch(self.breaks(unit), at)


def epoch(breaks: tuple[datetime, ...], at: datetime) -> tuple[datetime | None, datetime | None]:
    """The last of the breaks at or before a time and the first one after it."""
    before, after = [b for b in breaks if b <= at], [b for b in breaks if b > at]
    return max(before, default=None), min(after, default=None)


def _services() -> Select[ServiceRow, str]:
    return select(ServiceRow, UnitRow.serial).join(UnitRow, UnitRow.id == ServiceRow.unit_id)


def service_record(row: ServiceRow, serial: str) -> Service:
    """A stored break."""
    return Service(
        id=row.id,
        unit=serial,
        at=row.at,
        kind=row.kind,
        note=row.note,
        who=row.who,
        sensor=row.sensor,
        state=RecordState(row.state),
    )
