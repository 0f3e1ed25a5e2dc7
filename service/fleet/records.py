"""Filter and order of lists of units, and the announcements of the fleet page."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from service.fleet.use import Use
from service.groups.records import FoundTogether
from service.kit.listing import ListQuery
from service.sessions.decision import Verdict
from service.sessions.states import Questioned
from service.stands.records import StandCondition


class Order(StrEnum):
    """Order of a list of units; equal ones are ordered by serial number."""

    USE = "use"
    """Units that may not be used first, then by condition; a unit that falls due moves within an hour."""
    CONDITION = "condition"
    """Worst first, least margin to tolerance first."""
    DUE = "due"
    """Units that need work or another session first, then by the date of the next calibration."""
    SERIAL = "unit"
    TYPE = "type"
    LAST = "last"
    """The unit that was measured longest ago first."""


@dataclass(frozen=True)
class UseAt:
    """Units that have this answer at a time."""

    use: Use
    at: datetime


@dataclass(frozen=True)
class FleetQuery(ListQuery):
    """Filter of units, and the serial number after or before which the list goes on."""

    use: UseAt | None = None
    verdict: Verdict | None = None
    text: str | None = None
    """Part of the serial number or of the type's name, small and capital letters alike."""
    reserved: bool | None = None
    """Whether the verdict has a reservation; None where either will do."""
    due_before: datetime | None = None
    due_since: datetime | None = None
    undated: bool = False
    """Only units that wait for no date: a hand, another session, or the first one."""
    unit_type: str | None = None
    stand: str | None = None
    """Stand of the latest session."""
    lot: str | None = None
    flagged: bool | None = None
    """Whether the unit has an open flag; None where either will do."""
    location: str | None = None
    custodian: str | None = None
    uncalibrated: bool = False
    """Only registered units without a session that counts."""
    retired: bool | None = False
    """Whether the unit is retired; None where either will do."""
    unfit: bool = False
    """Only units that somebody must act on: unfit, probably unfit, or undecided."""
    order: Order = Order.USE


@dataclass(frozen=True)
class FleetChoices:
    """Possible filters of a fleet, each by name."""

    types: tuple[str, ...] = ()
    stands: tuple[str, ...] = ()
    lots: tuple[str, ...] = ()
    locations: tuple[str, ...] = ()
    custodians: tuple[str, ...] = ()


NOT_KNOWN = -1
"""Severity of a unit of which no session is accepted."""
UNCALIBRATED = -2
"""Severity of a registered unit without a session: the fleet lists it."""
RETIRED = -3
"""Severity of a retired unit, whatever its sessions: the fleet leaves it out."""
STEP, LAST = 10, 200
"""Per cent of the tolerance: width of a bar, and where the bar of everything beyond begins."""
NOT_JUDGED = -1
"""Bar of a unit of which nothing was judged."""


def bar_of(margin: float | None) -> int:
    """The tenth of its tolerance that a unit uses, uncertainty included."""
    if margin is None:
        return NOT_JUDGED
    return int(min(100 * (1 - margin), LAST) // STEP)


@dataclass(frozen=True)
class Tally:
    """Number of units in one condition with one tenth of tolerance used."""

    verdict: Verdict
    is_reference: bool
    is_simulated: bool
    bar: int
    units: int
    flags: int
    """Open flags on them."""
    reserved: int
    """Number of units whose verdict has a reservation."""


@dataclass(frozen=True)
class Announced:
    """Facts that concern many units, or wait for somebody."""

    stands: tuple[StandCondition, ...]
    """Stands that shift every unit measured on them, or did, by name."""
    questioned: tuple[Questioned, ...]
    """Sessions that wait for an engineer, the latest first."""
    found: tuple[FoundTogether, ...]
    """Findings of groups of sessions: of stands before types before units."""
    groups: int
    """Number of groups that show something, those that are not named too."""
