"""The fleet page: which units are fit, which are not, and which to look at first."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime

from estimator.message import joined, say_count
from service.fleet.condition import FleetCondition, UnitSummary
from service.fleet.records import FleetChoices
from service.groups.sections import FoundLine
from service.outlook.rules.populations import Standout
from service.outlook.words import needed_now
from service.pages.fleet.view import DUE, FIRST, ORDERS, PAGE_SIZE, FleetView
from service.pages.saved import Saved
from service.people.views import ListPage
from service.sessions.decision import Verdict
from service.sessions.doubt import Reservations
from service.sessions.states import Questioned
from service.sessions.words.conditions import REFERENCE, UNDECIDED, Condition, condition_of
from service.stands.records import StandCondition

MOST_STANDOUTS = 6
"""Lines above the list of units, so that the list stays in sight."""
NO_CHOICES = FleetChoices()
NONE_SAVED = Saved(ListPage.FLEET, (), "", own=False, may_share=False)
BAR_LIMIT = 150.0
"""The margin bar ends at one and a half tolerances, per cent."""


@dataclass(frozen=True)
class Margin:
    """How much of its tolerance a parameter uses up, uncertainty included: as words and as a bar."""

    words: str
    used: float
    """Length of the bar: 100 is the tolerance."""


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
    """Of the next calibration."""
    next: str
    """What is needed where no date is set: ``repeat``."""
    overdue: bool


@dataclass(frozen=True)
class Tile:
    """How many units are in one condition; a click shows only these."""

    condition: Condition
    count: int
    reserved: int
    """Of how many of them the verdict is said with a reservation."""
    references: int
    """Of how many of them the latest session is a reference."""
    chosen: bool
    url: str


@dataclass(frozen=True)
class FleetPage:
    """Everything the fleet page shows."""

    view: FleetView
    tiles: tuple[Tile, ...]
    rows: tuple[FleetRow, ...]
    total: int
    earlier: str
    """Address of the page before this one; empty where it is the first."""
    later: str
    """Address of the next page; empty where it is the last."""
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
    dates: Mapping[str, str]
    """Choices of the next calibration's date, in words."""
    orders: Mapping[str, str]
    """Of the list, in words."""
    saved: Saved
    """Views of the list that were kept."""

    @property
    def first(self) -> int:
        """Number of the first unit on this page, counted from 1."""
        return (self.view.page - 1) * PAGE_SIZE + 1

    @property
    def last(self) -> int:
        """Number of the last unit on this page, counted from 1."""
        return self.first + len(self.rows) - 1


def fleet_page(
    condition: FleetCondition,
    units: Sequence[UnitSummary],
    view: FleetView,
    now: datetime,
    *,
    overdue: int = 0,
    together: FoundLine | None = None,
    unlike: Sequence[Standout] = (),
    stands: Sequence[StandCondition] = (),
    questioned: Sequence[Questioned] = (),
    choices: FleetChoices = NO_CHOICES,
    kept: Saved = NONE_SAVED,
) -> FleetPage:
    """One page of units; one more than fit on it says that there are others in the direction of reading."""
    backwards, others = bool(view.before), len(units) > PAGE_SIZE
    shown = units[-PAGE_SIZE:] if backwards else units[:PAGE_SIZE]
    return FleetPage(
        view=view,
        tiles=tuple(_tile(v, condition, view) for v in reversed(condition.verdicts)),
        rows=tuple(fleet_row(unit, now) for unit in shown),
        total=condition.units,
        earlier=_earlier(view, shown),
        later=_later(view, shown) if backwards or others else "",
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
        orders=ORDERS,
        saved=kept,
    )


def _earlier(view: FleetView, shown: Sequence[UnitSummary]) -> str:
    """The first page is read from its beginning, so that nothing new is missed before it."""
    if view.page == 1:
        return ""
    if view.page == 2 or not shown:
        return view.url(**FIRST)
    return view.url(page=view.page - 1, before=shown[0].serial, after="")


def _later(view: FleetView, shown: Sequence[UnitSummary]) -> str:
    return view.url(page=view.page + 1, after=shown[-1].serial, before="") if shown else ""


def _tile(verdict: Verdict, fleet: FleetCondition, view: FleetView) -> Tile:
    condition = condition_of(verdict)
    chosen = view.condition == condition.key
    return Tile(
        condition=condition,
        count=fleet.verdicts[verdict],
        reserved=fleet.reserved.get(verdict, 0),
        references=fleet.references if verdict is Verdict.UNDECIDABLE else 0,
        chosen=chosen,
        url=view.url(condition="" if chosen else condition.key, **FIRST),
    )


def flags_in_words(count: int) -> str:
    """``2 flags``; empty for none."""
    return say_count("{n} flag", "{n} flags", count) if count else ""


def worst_in_words(unit: UnitSummary) -> str:
    """``A3 bias``."""
    return joined(" ", filter(None, (unit.worst_sensor, unit.worst_parameter)))


def fleet_row(unit: UnitSummary, now: datetime) -> FleetRow:
    """One unit of a list."""
    condition = condition_of(unit.verdict, is_reference=unit.is_reference)
    return FleetRow(
        serial=unit.serial,
        unit_type=unit.unit_type,
        condition=condition,
        reservations=unit.reservations,
        reason=unit.reason,
        worst=worst_in_words(unit),
        margin=None if condition in (UNDECIDED, REFERENCE) else margin_of(unit.margin),
        last_at=unit.last_at,
        last_session=unit.last_session,
        sessions=unit.sessions,
        simulated=unit.simulated,
        flags=flags_in_words(unit.flags),
        due=unit.due,
        next=needed_now(unit.verdict, known=unit.last_session is not None),
        overdue=unit.due is not None and unit.due < now,
    )


def margin_of(margin: float | None) -> Margin | None:
    """1 − (|d| + U)/T as what is used of T; None when nothing was judged."""
    if margin is None:
        return None
    used = 100 * (1 - margin)
    return Margin(f"{used:.0f} %", min(max(used, 0.0), BAR_LIMIT))
