"""The condition of one unit and of the fleet, at a glance."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import datetime

from pydantic import computed_field

from service.fleet.records import Tally
from service.kit.answer import Hidden, answer
from service.kit.measures import HARD, THIN, number
from service.kit.moments import epoch_ms
from service.outlook.records import UnitOutlook
from service.sessions.decision import Verdict
from service.sessions.doubt import Reservations
from service.types.records import UnitType
from service.units.records import NO_CUSTOMER, Customer, Registered


@dataclass(frozen=True)
class ToleranceUsed:
    """Of a tolerance T: by the deviation d, and by its expanded uncertainty."""

    deviation: float
    """|d|/T; beyond 1 the parameter is out of tolerance, probably where U reaches back to it."""
    expanded: float
    """U/T."""

    @property
    def words(self) -> str:
        """``83 ± 71 %``."""
        return f"{number(100 * self.deviation, 0)}{HARD}±{HARD}{number(100 * self.expanded, 0)}{THIN}%"


@answer
@dataclass(frozen=True)
class UnitSummary:
    """One unit in short."""

    serial: str
    """Serial number."""
    unit_type: str
    """Name of its type."""
    simulated: bool
    """Whether its sessions were simulated, not measured."""
    sessions: int
    """How many sessions are stored."""
    last_session: str | None
    """Id of the latest session."""
    last_at: datetime | None
    """When it was measured, UTC."""
    verdict: Verdict | None
    """Of the latest session."""
    is_reference: bool
    """Whether the latest session is one that later ones are judged against."""
    reason: str
    """Why, in one sentence."""
    worst_sensor: str | None
    """The sensor that the verdict hangs on."""
    worst_parameter: str | None
    """The parameter that the verdict hangs on."""
    margin: float | None
    """1 − (|d| + U)/T of it: 1 is no change, 0 the limit of a pass, negative beyond."""
    diagnosis: str = ""
    """What the simulation gets wrong about the latest session; empty if nothing."""
    gain: Hidden[str] = ""
    """What naming it gains, in one sentence."""
    flags: int = 0
    """How many flags are open."""
    due: datetime | None = None
    """When its next calibration is due, UTC."""
    due_reason: Hidden[str] = ""
    """Why then, in one sentence."""
    lot: str | None = None
    """Production lot, where it is recorded."""
    reservations: Hidden[Reservations] = ()
    """Reservations of the verdict."""
    customer: Hidden[Customer] = NO_CUSTOMER
    """For whom it is calibrated."""
    owner: str = ""
    """To whom it belongs, as the register says."""
    location: str = ""
    """Where it is, as the register says."""
    custodian: str = ""
    """Who has it, as the register says."""
    retired_at: datetime | None = None
    """Since when it is retired, UTC; null while it is in use."""
    is_undated: Hidden[bool] = False
    """Whether ``due`` and its outlook are still to be worked out with its latest records."""
    deviation: Hidden[float | None] = None
    """|d|/T of the parameter that the verdict hangs on."""
    failed: Hidden[str] = ""
    """Why what follows from its latest records could not be worked out; empty where it was, or still is."""

    @property
    def used(self) -> ToleranceUsed | None:
        """How much of its tolerance the worst parameter uses; None where that was not judged."""
        if self.margin is None or self.verdict in (None, Verdict.UNDECIDABLE):
            return None
        whole = 1 - self.margin
        deviation = whole if self.deviation is None else self.deviation
        return ToleranceUsed(deviation, whole - deviation)

    @computed_field  # type: ignore[prop-decorator]  # the one way to describe a property
    @property
    def last_at_ms(self) -> int | None:
        """`last_at` in milliseconds since 1970."""
        return None if self.last_at is None else epoch_ms(self.last_at)

    @computed_field  # type: ignore[prop-decorator]  # the one way to describe a property
    @property
    def due_ms(self) -> int | None:
        """`due` in milliseconds since 1970."""
        return None if self.due is None else epoch_ms(self.due)


@answer
@dataclass(frozen=True)
class FleetCondition:
    """The condition of the whole fleet."""

    units: int
    """How many units there are."""
    verdicts: dict[Verdict, int]
    """How many of them have each verdict."""
    simulated: int
    """How many of them were simulated, not measured."""
    flags: int = 0
    """How many flags are open."""
    reserved: dict[Verdict, int] = field(default_factory=dict)
    """Of how many with each verdict have a reservation."""
    overdue: Hidden[int] = 0
    """How many should have been calibrated by now; 0 where that was not asked."""
    references: int = 0
    """Of how many the latest session is a reference, which nothing was held against."""
    uncalibrated: int = 0
    """Of how many registered units no session counts yet."""

    @classmethod
    def of(cls, tallies: Sequence[Tally], of_groups: int = 0, uncalibrated: int = 0) -> "FleetCondition":
        """The sums of some counts; ``of_groups``: open flags of types and stands; ``uncalibrated``: registered units
        that no count is of."""
        counts = {verdict: [tally for tally in tallies if tally.verdict is verdict] for verdict in Verdict}
        return cls(
            units=sum(tally.units for tally in tallies) + uncalibrated,
            verdicts={verdict: sum(tally.units for tally in of_verdict) for verdict, of_verdict in counts.items()},
            simulated=sum(tally.units for tally in tallies if tally.is_simulated),
            flags=sum(tally.flags for tally in tallies) + of_groups,
            reserved={verdict: sum(tally.reserved for tally in of_verdict) for verdict, of_verdict in counts.items()},
            references=sum(tally.units for tally in tallies if tally.is_reference),
            uncalibrated=uncalibrated,
        )


@dataclass(frozen=True)
class UnitKnown:
    """What the page of a unit begins with."""

    summary: UnitSummary
    unit_type: UnitType
    waiting: int
    """Sessions that are still to be judged again after a change of the records."""
    reference_session: str | None
    """What the next session will be judged against; None when the next one becomes the reference."""
    outlook: UnitOutlook | None
    """None before a session was judged."""
    entry: Registered
    """What the register says."""
