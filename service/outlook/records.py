"""Next calibrations of units and their reasons: drift, forecast and risk as frozen records. SI inside."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from typing import Literal

from service.kit.answer import Hidden, answer

ChangeKind = Literal["jump", "drift", "aging", "walk"]


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
    """Due date of a unit's next calibration, and the reason."""

    unit: str
    at: datetime
    reason: str


@dataclass(frozen=True)
class FanPoint:
    """Quantiles of a parameter's deviation at a date, SI; relative for scale."""

    at: datetime
    low_90: float
    low_50: float
    middle: float
    high_50: float
    high_90: float


class Action(StrEnum):
    """Next action for a unit."""

    CALIBRATE = "calibrate"
    """The unit is to be calibrated at its due date."""
    NOW = "act-now"
    """The unit was found out of tolerance: adjust, repair or withdraw it; no date makes that better."""
    REPEAT = "repeat"
    """The latest session could not decide, or nearly so; measure again."""
    MEASURE = "measure"
    """No session has shown it yet, or none since its service."""


class DueRule(StrEnum):
    """The rule that decided when a unit comes back, or that it waits for no date."""

    INTERVAL = "interval"
    """The longest interval of its type, before its risk passes the level."""
    NO_TREND = "no-trend"
    """The longest interval, for one session gives no estimate of the risk."""
    RISK = "risk"
    """The chance that any parameter is out of tolerance passes the level."""
    MAY_BE_OUT = "may-be-out"
    """The chance that any parameter is out of tolerance passed the level at the latest session already."""
    UNDECIDED = "undecided"
    """The latest session did not decide."""
    UNFIT = "unfit"
    """A session found it out of tolerance."""
    SERVICED = "serviced"
    """No session has shown it since its last service."""
    UNMEASURED = "unmeasured"
    """No session has shown it."""


@answer
@dataclass(frozen=True)
class DueBasis:
    """The rule that set the date, with its parts."""

    rule: DueRule
    """The rule that decided."""
    at: datetime | None = None
    """Date of the session or the service from which it counts."""
    interval_days: float | None = None
    """Longest interval, where the rule is one."""
    risk: float | None = None
    """Chance of being out of tolerance at the date, where that set it."""
    sensor: str | None = None
    """The sensor that adds most to that chance."""
    parameter: str | None = None
    """The sensor's parameter that adds most to that chance."""
    because: Hidden[str] = ""
    """Reason why the session did not decide, in a sentence, for `DueRule.UNDECIDED`."""


@answer
@dataclass(frozen=True)
class FoundChange:
    """A change of one parameter that chance does not explain."""

    kind: ChangeKind
    """`walk`: it moved at no steady rate."""
    after: datetime
    """Last session before it, or the first of all."""
    before: datetime
    """First session that shows it."""
    size: float
    """SI or relative, of an axis its length; of a drift a year, of aging the first year's."""
    sigma: float
    """Standard uncertainty of it."""
    p_value: float
    """p-value over all kinds, sizes and times of change that were tried on the parameter."""


@answer
@dataclass(frozen=True)
class TemperatureCoefficient:
    """Dependence of a parameter on the temperature of its sessions."""

    value: float
    """SI or relative per °C; of an axis its length."""
    sigma: float
    """Standard uncertainty of it."""
    p_value: float
    """Chance of one this far from zero when there is none."""
    is_found: bool
    """Whether the trend goes on without it."""
    curvature: float | None = None
    """SI or relative per °C², of a parabola, whose `value` is that at the mean temperature; null of a straight line."""


@answer
@dataclass(frozen=True)
class ParameterTrend:
    """One parameter of one sensor since the unit's last break."""

    sensor: str
    """Name of the sensor."""
    parameter: str
    """`scale`, `bias`, `quadratic`, `axis` or `misalignment`."""
    rate_per_year: float
    """Drift a year."""
    rate_sigma: float
    """Standard uncertainty of it, that of the random walk included."""
    significance: float
    """p-value: chance of changes as evident, of any kind and at any time, where nothing happens."""
    step_dates: tuple[datetime, ...]
    """Sessions that first showed a sudden change."""
    level: float
    """Deviation at the last session, all sessions considered."""
    level_sigma: float
    """Standard uncertainty of it."""
    reach_50: datetime | None
    """Date by which the tolerance is reached with 50 % probability."""
    reach_90: datetime | None
    """Date before which the tolerance is reached with only 10 % probability."""
    population_z: float | None
    """The rate among those of the type's units, in their robust spread."""
    kind: str = ""
    """`accelerometer` or `gyroscope`."""
    tolerance: float = 1.0
    """T, SI; relative for scale."""
    since: Hidden[datetime | None] = None
    """Date of the first session of the trend: the reference, or the first after a sudden change."""
    fan: Hidden[tuple[FanPoint, ...]] = ()
    """Forecast from the last session on, a year ahead."""
    changes: tuple[FoundChange, ...] = ()
    """Changes that chance does not explain, most evident first."""
    temperature: TemperatureCoefficient | None = None
    """Dependence on the sessions' temperature; null where they do not span any."""


@answer
@dataclass(frozen=True)
class RiskPoint:
    """The risk of waiting until a date."""

    at: datetime
    """Date, UTC."""
    risk: float
    """Chance that any parameter has reached its tolerance by then."""


@answer
@dataclass(frozen=True)
class UnitOutlook:
    """Next calibration of a unit, its reason, and the risk of waiting."""

    serial: str
    """Serial number."""
    due: datetime | None
    """Next calibration: before the risk passes 5 %, never after the longest interval; null: at once."""
    overdue: bool
    """Whether that has passed."""
    reason: str
    """Reason for that date in one sentence, made from `basis`."""
    sensor: str | None
    """The sensor that reaches its tolerance first."""
    parameter: str | None
    """The parameter that reaches its tolerance first."""
    reach_50: datetime | None
    """Date by which the tolerance is reached with 50 % probability."""
    reach_90: datetime | None
    """Date before which the tolerance is reached with only 10 % probability."""
    risk_at_due: float | None
    """Chance that any parameter is out of tolerance by the due date."""
    trends: tuple[ParameterTrend, ...]
    """One a sensor and parameter."""
    unit_type: str = ""
    """Name of its type."""
    lot: str | None = None
    """Production lot, where it is recorded."""
    risk: tuple[RiskPoint, ...] = ()
    """The risk of waiting, from the latest session on."""
    together: Hidden[tuple[str, ...]] = ()
    """Motions common to all sensors at the latest calibration, in sentences."""
    action: Action = Action.CALIBRATE
    """Next action for the unit."""
    learned_from: int = 0
    """Histories of the type that the forecast rests on; 0 where it rests on units in general."""
    failed: str = ""
    """Reason why the outlook could not be computed with the latest records, and who must act; empty where it was."""
    rests_on: Hidden[str] = ""
    """Hash of those histories: another one means that the type has more to tell."""
    basis: DueBasis | None = None
    """The rule that set the date; null in an outlook that an earlier version made, until it is renewed."""

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


@answer
@dataclass(frozen=True)
class OutlookAnswer(UnitOutlook):
    """Next calibration of a unit, its reason, and the risk of waiting."""

    until: RiskPoint | None = None
    """The risk of waiting until the date that was asked for."""
