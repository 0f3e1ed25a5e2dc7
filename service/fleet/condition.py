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
    """Share of a tolerance T used by the deviation d, and by its expanded uncertainty."""

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
    """Number of stored sessions."""
    last_session: str | None
    """Id of the latest session."""
    last_at: datetime | None
    """Start of the latest session, UTC."""
    verdict: Verdict | None
    """Verdict of the latest session."""
    is_reference: bool
    """Whether the latest session is one that later ones are judged against."""
    reason: str
    """Reason for the verdict, in one sentence."""
    worst_sensor: str | None
    """Sensor that sets the verdict."""
    worst_parameter: str | None
    """Parameter that sets the verdict."""
    margin: float | None
    """1 − (|d| + U)/T of it: 1 is no change, 0 the limit of a pass, negative beyond."""
    diagnosis: str = ""
    """Diagnosis of the latest session in one line; empty where nothing is wrong."""
    gain: Hidden[str] = ""
    """Gain from the named causes, in one sentence."""
    flags: int = 0
    """Number of open flags."""
    due: datetime | None = None
    """Due date of its next calibration, UTC."""
    due_reason: Hidden[str] = ""
    """Reason for the due date, in one sentence."""
    lot: str | None = None
    """Production lot, where it is recorded."""
    reservations: Hidden[Reservations] = ()
    """Reservations of the verdict."""
    customer: Hidden[Customer] = NO_CUSTOMER
    """Customer for whom it is calibrated."""
    owner: str = ""
    """Owner by the register."""
    location: str = ""
    """Location by the register."""
    custodian: str = ""
    """Custodian by the register."""
    retired_at: datetime | None = None
    """Time of retirement, UTC; null while it is in use."""
    is_undated: Hidden[bool] = False
    """Whether ``due`` and its outlook are still to be worked out with its latest records."""
    deviation: Hidden[float | None] = None
    """|d|/T of the parameter that sets the verdict."""
    failed: Hidden[str] = ""
    """Reason why the results from its latest records could not be computed; empty where they were, or still are
    being.
    """

    @property
    def used(self) -> ToleranceUsed | None:
        """Share of its tolerance that the worst parameter uses; None where that was not judged."""
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
    """Number of units."""
    verdicts: dict[Verdict, int]
    """Number of units by verdict."""
    simulated: int
    """Number of units that were simulated, not measured."""
    flags: int = 0
    """Number of open flags."""
    reserved: dict[Verdict, int] = field(default_factory=dict)
    """Number of units with a reservation, by verdict."""
    overdue: Hidden[int] = 0
    """Number of units whose calibration is overdue; 0 where that was not asked."""
    references: int = 0
    """Number of units whose latest session is a reference, which nothing was held against."""
    uncalibrated: int = 0
    """Number of registered units without a session that counts."""

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
    """Contents of the head of a unit's page."""

    summary: UnitSummary
    unit_type: UnitType
    waiting: int
    """Sessions that are still to be judged again after a change of the records."""
    reference_session: str | None
    """Reference for the next session; None where the next one becomes the reference."""
    outlook: UnitOutlook | None
    """Outlook of the unit; None before a session was judged."""
    entry: Registered
    """Entry in the register."""
