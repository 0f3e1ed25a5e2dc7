"""When a unit must come back and why."""

from dataclasses import dataclass

from service.kit.answer import answer
from service.outlook.records import RiskPoint, UnitOutlook


@answer
@dataclass(frozen=True)
class OutlookAnswer(UnitOutlook):
    """When a unit must be calibrated next, why, and what waiting costs."""

    until: RiskPoint | None = None
    """The risk of waiting until the date that was asked for."""
