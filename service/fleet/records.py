"""Which units are wanted and in which order, what the fleet page announces, and whether a unit may be used."""

from dataclasses import dataclass
from datetime import date, datetime
from enum import StrEnum

from pydantic import computed_field

from estimator.message import joined
from service.groups.records import FoundTogether
from service.kit.answer import answer
from service.kit.listing import ListQuery
from service.sessions.decision import Verdict
from service.sessions.states import Questioned
from service.stands.records import StandCondition


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
class FleetQuery(ListQuery):
    """Which units are wanted, and after or before which serial number."""

    verdict: Verdict | None = None
    text: str | None = None
    """Part of the serial number or of the type's name, small and capital letters alike."""
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
    unfit: bool = False
    """Only units that somebody must act on: unfit, probably unfit, or undecided."""
    order: Order = Order.CONDITION


@dataclass(frozen=True)
class FleetChoices:
    """What a fleet can be narrowed to, each by name."""

    types: tuple[str, ...] = ()
    stands: tuple[str, ...] = ()
    lots: tuple[str, ...] = ()


NOT_KNOWN = -1
"""Severity of a unit of which no session is accepted."""
STEP, LAST = 10, 200
"""Per cent of the tolerance: width of a bar, and where the bar of everything beyond begins."""
NOT_JUDGED = -1
"""Bar of a unit of which nothing was judged."""


def bar_of(margin: float | None) -> int:
    """Which tenth of its tolerance a unit uses up, uncertainty included."""
    if margin is None:
        return NOT_JUDGED
    return int(min(100 * (1 - margin), LAST) // STEP)


@dataclass(frozen=True)
class Tally:
    """How many units are in one condition and use so much of their tolerance."""

    verdict: Verdict
    is_reference: bool
    is_simulated: bool
    bar: int
    units: int
    flags: int
    """That are open on them."""
    reserved: int
    """Of how many the verdict is said with a reservation."""


@dataclass(frozen=True)
class Announced:
    """What concerns many units, or waits for somebody."""

    stands: tuple[StandCondition, ...]
    """That shift every unit measured on them, or did, by name."""
    questioned: tuple[Questioned, ...]
    """Sessions that wait for an engineer, the latest first."""
    found: tuple[FoundTogether, ...]
    """What sessions show together: of stands before types before units."""
    groups: int
    """How many groups show something, those that are not named too."""


@answer
@dataclass(frozen=True)
class Usable:
    """Whether a unit may be used now, and why."""

    usable: bool
    """In doubt it is false."""
    why: str
    """In one sentence."""
    reasons: tuple[str, ...]
    """Everything that speaks against it; empty where it may be used."""
    reservations: tuple[str, ...]
    """What must be known although it does not forbid the use."""
    until: datetime | None
    """The next calibration is due then, UTC."""
    verdict: Verdict | None
    """Of the session that the answer rests on."""
    session: str | None
    """The latest judged one; null where there is none since the last service."""
    correction: str | None
    """Id of the session whose correction firmware applies; null where no session calibrates every sensor."""
    as_of: datetime
    """When it was asked, UTC."""

    @computed_field  # type: ignore[prop-decorator]  # the one way to describe a property
    @property
    def reservation(self) -> str:
        """The same as one text; empty where there is none."""
        return joined(" ", self.reservations)

    @computed_field  # type: ignore[prop-decorator]  # the one way to describe a property
    @property
    def next_calibration(self) -> date | None:
        """The day of it."""
        return None if self.until is None else self.until.date()
