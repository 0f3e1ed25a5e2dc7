"""The fleet page: which units may be used, what must be done with the others, and which come first."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime

from estimator.message import capitalised, joined, say_count
from service.fleet.condition import FleetCondition, ToleranceUsed, UnitSummary
from service.fleet.records import FleetChoices
from service.fleet.use import COUNT_WORDS, WORDS, Use, counted_uses
from service.groups.sections import FoundLine
from service.judging.records import Usable
from service.kit.copying import copied
from service.outlook.rules.populations import Standout
from service.pages.fleet.view import DUE, RETIRED, USES, FleetView
from service.sessions.states import Questioned
from service.stands.records import StandCondition
from service.web.list_view import Shown

MOST_STANDOUTS = 6
"""Lines above the list of units, so that the list stays in sight."""
NO_CHOICES = FleetChoices()
NO_UNITS: Mapping[Use, int] = dict.fromkeys(Use, 0)
SHORT = {**WORDS, Use.RESERVED: "With reservation"}
"""The answers where there is little room."""
BAR_LIMIT = 150.0
"""The margin bar ends at one and a half tolerances, per cent."""


@dataclass(frozen=True)
class Margin:
    """Share of its tolerance that a parameter uses, uncertainty included: as words and as a bar."""

    words: str
    """``83 ± 71 %``."""
    used: float
    """Length of the bar of the deviation: 100 is the tolerance."""
    reach: float
    """End of U on the bar."""


@dataclass(frozen=True)
class FleetRow:
    """One unit."""

    serial: str
    unit_type: str
    use: Use
    word: str
    """The answer alone: ``Do not use``."""
    action: str
    """Action that is due; empty where there is none."""
    reason: str
    """Reason for the action, in one sentence; empty where there is none."""
    worst: str
    margin: Margin | None
    last_at: datetime | None
    last_session: str | None
    simulated: bool
    due: datetime | None
    """Date of the next calibration; None where something else must be done first."""
    overdue: bool
    where: str
    """Location and custodian; empty where neither is known."""
    retired: bool


@dataclass(frozen=True)
class UseCount:
    """Number of units with one answer; a click shows only these."""

    use: Use
    words: str
    """``9 must not be used``, the number first."""
    count: int
    chosen: bool
    url: str


@dataclass(frozen=True)
class FleetConcern:
    """A matter of several units, in a few words, and the address of its full text."""

    words: str
    url: str


@dataclass(frozen=True)
class FleetPage:
    """Everything the fleet page shows."""

    view: FleetView
    counts: tuple[UseCount, ...]
    rows: tuple[FleetRow, ...]
    total: int
    shown: Shown[UnitSummary]
    all_simulated: bool
    """Whether no session of any unit was measured."""
    simulated: int
    stands: tuple[StandCondition, ...]
    """Stands that shift every unit measured on them, or did."""
    standouts: tuple[Standout, ...]
    """Units and lots that drift unlike the others."""
    questioned: tuple[Questioned, ...]
    """Sessions that wait for an engineer, the latest first."""
    together: FoundLine | None
    """Joint findings of sessions that none shows alone; None where there are none."""
    concerns: tuple[FleetConcern, ...]
    choices: FleetChoices
    """Possible filters of the list."""
    retired: Mapping[str, str]
    """Choices for retired units, in words."""
    uses: Mapping[str, str]
    """Choices of permitted use, in words."""
    dates: Mapping[str, str]
    """Choices of the next calibration's date, in words."""
    pending: str
    """Pending work in words; empty where there is none."""
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
    used: Mapping[Use, int] = NO_UNITS,
    overdue: int = 0,
    together: FoundLine | None = None,
    unlike: Sequence[Standout] = (),
    stands: Sequence[StandCondition] = (),
    questioned: Sequence[Questioned] = (),
    choices: FleetChoices = NO_CHOICES,
    pending: str = "",
    follow: int | None = None,
) -> FleetPage:
    """One page of units, and the number of all units by permitted use."""
    shown = Shown.of(view, units, lambda unit: unit.serial)
    return FleetPage(
        view=view,
        counts=use_counts(used, view),
        rows=tuple(fleet_row(unit, uses[unit.serial]) for unit in shown.entries),
        total=condition.units,
        shown=shown,
        all_simulated=0 < condition.simulated == condition.units - condition.uncalibrated,
        simulated=condition.simulated,
        stands=tuple(stands),
        standouts=tuple(unlike),
        questioned=tuple(questioned),
        together=together,
        concerns=tuple(_concerns(overdue, stands, questioned, together, unlike)),
        choices=choices,
        dates=DUE,
        retired=RETIRED,
        uses=USES,
        pending=pending,
        follow=follow,
    )


def _concerns(
    overdue: int,
    stands: Sequence[StandCondition],
    questioned: Sequence[Questioned],
    together: FoundLine | None,
    unlike: Sequence[Standout],
) -> Iterator[FleetConcern]:
    if overdue:
        yield FleetConcern(say_count("{n} is overdue", "{n} are overdue", overdue), "/?due=overdue&sort=due")
    shifted = sum(stand.has_shifted for stand in stands)
    if shifted:
        yield FleetConcern(say_count("{n} stand has shifted", "{n} stands have shifted", shifted), "#stands")
    if questioned:
        words = say_count("{n} session waits for an engineer", "{n} sessions wait for an engineer", len(questioned))
        yield FleetConcern(words, "#questioned")
    if together:
        groups = len(together.found) + together.more
        yield FleetConcern(say_count("{n} common effect", "{n} common effects", groups), "#together")
    if unlike:
        yield FleetConcern(say_count("{n} unlike its type", "{n} unlike their type", len(unlike)), "#unlike")


def use_counts(used: Mapping[Use, int], view: FleetView) -> tuple[UseCount, ...]:
    """Units by what they may be used for, those that must not be used first."""
    return tuple(
        UseCount(
            use, COUNT_WORDS[use], count, view.use == use, view.first(use="" if view.use == use else use.value)
        )
        for use, count in counted_uses(used)
    )  # fmt: skip


def flags_in_words(count: int) -> str:
    """``2 flags``; empty for none."""
    return say_count("{n} flag", "{n} flags", count) if count else ""


def fleet_row(unit: UnitSummary, usable: Usable) -> FleetRow:
    """One unit of a list."""
    return copied(
        FleetRow,
        unit,
        use=usable.answer,
        word=SHORT[usable.answer],
        action=capitalised(usable.action),
        reason=usable.objection,
        worst=joined(" ", filter(None, (unit.worst_sensor, unit.worst_parameter))),
        margin=None if unit.used is None else margin_of(unit.used),
        due=usable.due,
        overdue=usable.is_overdue,
        where=joined(", ", filter(None, (unit.location, unit.custodian))),
        retired=unit.retired_at is not None,
    )


def margin_of(used: ToleranceUsed) -> Margin:
    """The used tolerance as words and a bar, per cent."""
    deviation, expanded = 100 * used.deviation, 100 * used.expanded
    return Margin(used.words, min(deviation, BAR_LIMIT), min(deviation + expanded, BAR_LIMIT))
