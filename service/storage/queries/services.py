"""Known breaks in units' histories."""

from dataclasses import asdict
from datetime import datetime

from sqlalchemy import Select, select

from service.records.event import NewService, Service
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
        row, serial = self._session.execute(_services().where(ServiceRow.id == number)).one()
        return service_record(row, serial)

    def of_unit(self, serial: str) -> tuple[Service, ...]:
        """All breaks of a unit, oldest first."""
        found = self._session.execute(
            _services().where(UnitRow.serial == serial).order_by(ServiceRow.at, ServiceRow.id)
        )
        return tuple(service_record(row, owner) for row, owner in found)

    def around(self, unit: int, at: datetime) -> tuple[datetime | None, datetime | None]:
        """The last break at or before a time and the first one after it: the epoch that the time is in."""
        return epoch(tuple(self._session.scalars(select(ServiceRow.at).where(ServiceRow.unit_id == unit))), at)


def epoch(breaks: tuple[datetime, ...], at: datetime) -> tuple[datetime | None, datetime | None]:
    """The last of the breaks at or before a time and the first one after it."""
    before, after = [b for b in breaks if b <= at], [b for b in breaks if b > at]
    return max(before, default=None), min(after, default=None)


def _services() -> Select[ServiceRow, str]:
    return select(ServiceRow, UnitRow.serial).join(UnitRow, UnitRow.id == ServiceRow.unit_id)


def service_record(row: ServiceRow, serial: str) -> Service:
    """A stored break."""
    return Service(id=row.id, unit=serial, at=row.at, kind=row.kind, note=row.note, who=row.who, sensor=row.sensor)
