"""When a unit must come back and why: drift, forecast and risk as frozen records. SI inside."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum


@dataclass(frozen=True)
class Rate:
    """The drift of one parameter of one sensor, in tolerances a year."""

    unit_type: str
    lot: str | None
    serial: str
    sensor: str
    kind: str
    parameter: str
    value: float
    sigma: float
    significance: float = 1.0
    """The chance of changes as evident as those that it was found from, where nothing happens."""
    tolerance: float = 1.0
    """SI; relative for scale."""


@dataclass(frozen=True)
class DueDate:
    """When a unit must come back, and why then."""

    unit: str
    at: datetime
    reason: str


@dataclass(frozen=True)
class FanPoint:
    """Where a parameter's deviation will be at a date: quantiles, SI; relative for scale."""

    at: datetime
    low_90: float
    low_50: float
    middle: float
    high_50: float
    high_90: float


class Action(StrEnum):
    """What a unit needs next."""

    CALIBRATE = "calibrate"
    """At its due date."""
    NOW = "act-now"
    """It was found out of tolerance: adjust, repair or withdraw it; no date makes that better."""
    REPEAT = "repeat"
    """Its latest session could not decide, or hardly knows; measure again."""
    MEASURE = "measure"
    """No session has shown it yet, or none since its service."""


class DueRule(StrEnum):
    """The rule that decided when a unit comes back, or that it waits for no date."""

    INTERVAL = "interval"
    """The longest interval of its type, before its risk passes the level."""
    NO_TREND = "no-trend"
    """The same interval, for one session gives no estimate of the risk."""
    RISK = "risk"
    """The chance that any parameter is out of tolerance passes the level."""
    MAY_BE_OUT = "may-be-out"
    """That chance passed the level at the latest session already."""
    UNDECIDED = "undecided"
    """The latest session did not decide."""
    UNFIT = "unfit"
    """A session found it out of tolerance."""
    SERVICED = "serviced"
    """No session has shown it since its last service."""
    UNMEASURED = "unmeasured"
    """No session has shown it."""


@dataclass(frozen=True)
class DueBasis:
    """What set a date: the one fact that every sentence about the date is made from."""

    rule: DueRule
    at: datetime | None = None
    """Of the session or the service that the rule starts from."""
    interval_days: float | None = None
    """Of `DueRule.INTERVAL` and `DueRule.NO_TREND`."""
    risk: float | None = None
    """The level, of `DueRule.RISK` and `DueRule.MAY_BE_OUT`."""
    sensor: str | None = None
    """That adds most to the risk, of the same two."""
    parameter: str | None = None
    because: str = ""
    """Why the session did not decide, in a sentence, of `DueRule.UNDECIDED`."""


@dataclass(frozen=True)
class FoundChange:
    """A change of one parameter that chance does not explain."""

    kind: str
    """``jump``, ``drift``, ``aging``, or ``walk``: at no steady rate."""
    after: datetime
    """The last session before it; of a drift from the start, and of a walk, the first session."""
    before: datetime
    """The first session that shows it."""
    size: float
    """SI or relative, for the axis its length; of a drift a year, of an aging the change of its first year."""
    sigma: float
    p_value: float
    """Over all kinds, sizes and times of change that were tried on the parameter."""


@dataclass(frozen=True)
class TemperatureCoefficient:
    """How a parameter follows the temperature of its sessions."""

    value: float
    """SI or relative per °C; for the axis its length."""
    sigma: float
    p_value: float
    is_found: bool
    """Whether the trend goes on without it."""


@dataclass(frozen=True)
class ParameterTrend:
    """One parameter of one sensor since the last break."""

    sensor: str
    parameter: str
    rate_per_year: float
    """SI a year; relative for scale; for the axis along the direction in which it has moved."""
    rate_sigma: float
    significance: float
    """p-value: the chance of changes as evident as these, of any kind and at any time, where nothing happens."""
    step_dates: tuple[datetime, ...]
    """Sessions that first showed a sudden change."""
    level: float
    """Deviation from the reference at the last session, all sessions considered."""
    level_sigma: float
    reach_50: datetime | None
    """The tolerance is reached by then with 50 % probability; None beyond twelve years."""
    reach_90: datetime | None
    """The early bound: before it the tolerance is reached with only 10 % probability."""
    population_z: float | None
    """How far the rate stands from those of the other units of the type, in their robust spread; None with too few."""
    kind: str = ""
    tolerance: float = 1.0
    since: datetime | None = None
    """Of the first session that the trend goes through: the reference, or the first after a sudden change."""
    fan: tuple[FanPoint, ...] = ()
    """From the last session on, a year ahead."""
    changes: tuple[FoundChange, ...] = ()
    """What was found at the level over all parameters of the unit, the most evident first."""
    temperature: TemperatureCoefficient | None = None
    """None where the sessions do not span temperature."""


@dataclass(frozen=True)
class RiskPoint:
    """Chance that any parameter of the unit has reached its tolerance by a date."""

    at: datetime
    risk: float


@dataclass(frozen=True)
class UnitOutlook:
    """When a unit must be calibrated next and what its parameters do until then."""

    serial: str
    due: datetime | None
    """None for a unit without a calibration session."""
    overdue: bool
    reason: str
    """Why then, in one sentence a technician understands."""
    sensor: str | None
    """That reaches its tolerance first; None where none does within twelve years."""
    parameter: str | None
    reach_50: datetime | None
    reach_90: datetime | None
    risk_at_due: float | None
    """Chance that any parameter is out of tolerance by the due date; None where there is no trend yet."""
    trends: tuple[ParameterTrend, ...]
    unit_type: str = ""
    lot: str | None = None
    risk: tuple[RiskPoint, ...] = ()
    """The risk of waiting, date by date from the latest session on."""
    together: tuple[str, ...] = ()
    """What all sensors did together at the latest calibration, in sentences."""
    action: Action = Action.CALIBRATE
    learned_from: int = 0
    """Histories of its type that the forecast rests on; 0 where it rests on units in general."""
    failed: str = ""
    """That it could not be worked out with the latest records, why and who must act; empty else."""
    rests_on: str = ""
    """Hash of those histories: another one means that the type has more to tell."""
    basis: DueBasis | None = None
    """What set the date; None in an outlook of an earlier version."""

    def risk_by(self, at: datetime) -> float | None:
        """Chance that any parameter is out of tolerance by a date; None where there is no trend."""
        if not self.risk:
            return None
        before = [point for point in self.risk if point.at <= at]
        after = [point for point in self.risk if point.at > at]
        if not before or not after:
            return (before or after)[-1 if before else 0].risk
        low, high = before[-1], after[0]
        share = (at - low.at) / (high.at - low.at)
        return low.risk + share * (high.risk - low.risk)
