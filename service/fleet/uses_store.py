"""Counts of units by what they may be used for."""

from collections import Counter
from datetime import datetime

from sqlalchemy import func, select

from service.fleet.tables import ConditionRow, UseRow
from service.fleet.use import Use
from service.fleet.wanted_store import forbids
from service.outlook.tables import OutlookRow
from service.storage.queries import Queries
from service.types.tables import UnitTypeRow
from service.units.tables import UnitRow


class Uses(Queries):
    """What units may be used for, counted."""

    def at(self, now: datetime) -> Counter[Use]:
        """Number of units of the fleet, retired ones apart, that have each answer at a time."""
        return sum(self.by_type_at(now).values(), Counter[Use]())

    def by_type_at(self, now: datetime) -> dict[str, Counter[Use]]:
        """Number of units of each type, retired ones apart, that have each answer at a time."""
        counted = (
            select(UnitTypeRow.name, UseRow.answer, func.count())
            .join(UnitRow, UnitRow.unit_type_id == UnitTypeRow.id)
            .join(UseRow, UseRow.unit_id == UnitRow.id)
            .where(UseRow.is_listed)
            .group_by(UnitTypeRow.name, UseRow.answer)
        )
        found: dict[str, Counter[Use]] = {}
        for unit_type, answer, count in self._session.execute(counted):
            found.setdefault(unit_type, Counter())[Use(answer)] += count
        clocked = counted.outerjoin(OutlookRow, OutlookRow.unit_id == UnitRow.id).outerjoin(
            ConditionRow, ConditionRow.unit_id == UnitRow.id
        )
        for unit_type, answer, count in self._session.execute(clocked.where(forbids(now))):
            found[unit_type][Use(answer)] -= count
            found[unit_type][Use.NO] += count
        return found
