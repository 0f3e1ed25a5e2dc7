"""The fleet page: which units are fit, which are not, and which to look at first."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime

from estimator.message import joined, say_count
from service.fleet.condition import ConditionCount, FleetCondition, ToleranceUsed, UnitSummary
from service.fleet.records import FleetChoices
from service.groups.sections import FoundLine
from service.judging.records import Usable
from service.judging.use import Use
from service.kit.copying import copied
from service.outlook.rules.populations import Standout
from service.pages.fleet.view import DUE, RETIRED, FleetView
from service.sessions.doubt import Reservations
from service.sessions.states import Questioned
from service.sessions.words.conditions import Condition, condition_of
from service.stands.records import StandCondition
from service.web.list_view import Shown

MOST_STANDOUTS = 6
"""Lines above the list of units, so that the list stays in sight."""
NO_CHOICES = FleetChoices()
BAR_LIMIT = 150.0
"""The margin bar ends at one and a half tolerances, per cent."""


@dataclass(frozen=True)
class Margin:
    """How much of its tolerance a parameter uses up, uncertainty included: as words and as a bar."""

    words: str
    """``83 ± 71 %``."""
    used: float
    """Length of the bar of the deviation: 100 is the tolerance."""
    reach: float
    """Where U ends."""


@dataclass(frozen=True)
class FleetRow:
    """One unit."""

    serial: str
    unit_type: str
    condition: Condition
    reservations: Reservations
    reason: str
    worst: str
    margin: Margin | None
    last_at: datetime | None
    last_session: str | None
    sessions: int
    simulated: bool
    flags: str
    """``2 flags``; empty where none is open."""
    due: datetime | None
    """Of the next calibration; None where something else must be done first."""
    use: Use
    said: str
    """What it may be used for, and what to do."""
    overdue: bool
    where: str
    """Location and custodian; empty where neither is known."""
    retired: bool


@dataclass(frozen=True)
class Tile:
    """How many units are in one condition; a click shows only these."""

    condition: Condition
    count: int
    reserved: int
    """Of how many of them the verdict has a reservation."""
    chosen: bool
    url: str


@dataclass(frozen=True)
class FleetPage:
    """Everything the fleet page shows."""

    view: FleetView
    tiles: tuple[Tile, ...]
    rows: tuple[FleetRow, ...]
    total: int
    shown: Shown[UnitSummary]
    all_simulated: bool
    """Whether no session of any unit was measured."""
    simulated: int
    flags: str
    """How many are open on all units together, in words; empty where none is."""
    stands: tuple[StandCondition, ...]
    """That shift every unit measured on them, or did."""
    standouts: tuple[Standout, ...]
    """Units and lots that drift unlike the others."""
    questioned: tuple[Questioned, ...]
    """Sessions that wait for an engineer, the latest first."""
    together: FoundLine | None
    """What sessions together show that none shows alone; None where they show nothing."""
    overdue: str
    """How many units are overdue, in words; empty where none is."""
    choices: FleetChoices
    """What the list can be narrowed to."""
    retired: Mapping[str, str]
    """What can be shown of retired units, in words."""
    dates: Mapping[str, str]
    """Choices of the next calibration's date, in words."""
    pending: str
    """What is still being worked out; empty where nothing is."""
    follow: int | None
    """Seconds until that line looks again; None where it need not."""

    @property
    def first(self) -> int:
        """Number of the first unit on this page, counted from 1."""
        return (self.view.page - 1) * self.view.PAGE_SIZE + 1

    @property
    def last(self) -> int:
        """Number of the last unit on this page, counted from 1."""
        return self.first + len(self.rows) - 1


def fleet_page(
    condition: FleetCondition,
    units: Sequence[UnitSummary],
    uses: Mapping[str, Usable],
    view: FleetView,
    *,
    overdue: int = 0,
    together: FoundLine | None = None,
    unlike: Sequence[Standout] = (),
    stands: Sequence[StandCondition] = (),
    questioned: Sequence[Questioned] = (),
    choices: FleetChoices = NO_CHOICES,
    pending: str = "",
    follow: int | None = None,
) -> FleetPage:
    """One page of units."""
    shown = Shown.of(view, units, lambda unit: unit.serial)
    return FleetPage(
        view=view,
        tiles=tuple(_tile(counted, view) for counted in condition.counts),
        rows=tuple(fleet_row(unit, uses[unit.serial]) for unit in shown.entries),
        total=condition.units,
        shown=shown,
        all_simulated=0 < condition.simulated == condition.units - condition.uncalibrated,
        simulated=condition.simulated,
        flags=flags_in_words(condition.flags),
        stands=tuple(stands),
        standouts=tuple(unlike),
        questioned=tuple(questioned),
        together=together,
        overdue=say_count("{n} unit overdue for calibration", "{n} units overdue for calibration", overdue)
        if overdue
        else "",
        choices=choices,
        dates=DUE,
        retired=RETIRED,
        pending=pending,
        follow=follow,
    )


def _tile(counted: ConditionCount, view: FleetView) -> Tile:
    chosen = view.condition == counted.condition.key
    url = view.first(condition="" if chosen else counted.condition.key)
    return Tile(counted.condition, counted.count, counted.reserved, chosen, url)


def flags_in_words(count: int) -> str:
    """``2 flags``; empty for none."""
    return say_count("{n} flag", "{n} flags", count) if count else ""


def fleet_row(unit: UnitSummary, usable: Usable) -> FleetRow:
    """One unit of a list."""
    condition = condition_of(unit.verdict, is_reference=unit.is_reference)
    return copied(
        FleetRow,
        unit,
        condition=condition,
        worst=joined(" ", filter(None, (unit.worst_sensor, unit.worst_parameter))),
        margin=None if unit.used is None else margin_of(unit.used),
        flags=flags_in_words(unit.flags),
        due=usable.due,
        use=usable.answer,
        said=usable.use,
        overdue=usable.is_overdue,
        where=joined(", ", filter(None, (unit.location, unit.custodian))),
        retired=unit.retired_at is not None,
    )


def margin_of(used: ToleranceUsed) -> Margin:
    """In per cent of the tolerance."""
    deviation, expanded = 100 * used.deviation, 100 * used.expanded
    return Margin(used.words, min(deviation, BAR_LIMIT), min(deviation + expanded, BAR_LIMIT))
