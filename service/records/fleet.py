"""Which units of the fleet are wanted, and in which order."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from service.records.decision import Verdict


class Order(StrEnum):
    """What units are listed by; serial numbers order those that are alike."""

    CONDITION = "condition"
    """Worst first, least margin to tolerance first."""
    DUE = "due"
    """What needs a hand or another session first, then by the date of the next calibration."""
    SERIAL = "unit"
    TYPE = "type"
    LAST = "last"
    """The unit that was measured longest ago first."""


@dataclass(frozen=True)
class FleetQuery:
    """Which units are wanted."""

    verdict: Verdict | None = None
    text: str | None = None
    """Part of the serial number or of the type's name, small and capital letters alike."""
    offset: int = 0
    limit: int = 100
    reserved: bool | None = None
    """Whether the verdict is said with a reservation; None where either will do."""
    due_before: datetime | None = None
    undated: bool = False
    """Only units that wait for no date: a hand, another session, or the first one."""
    unit_type: str | None = None
    stand: str | None = None
    """Where the latest session was measured."""
    lot: str | None = None
    flagged: bool = False
    """Only units with an open flag."""
    order: Order = Order.CONDITION
    backwards: bool = False


@dataclass(frozen=True)
class FleetChoices:
    """What a fleet can be narrowed to, each by name."""

    types: tuple[str, ...] = ()
    stands: tuple[str, ...] = ()
    lots: tuple[str, ...] = ()
