"""When a unit must come back, in words: the date, why, what moves, and the risk of waiting."""

from dataclasses import dataclass
from datetime import timedelta
from math import floor, log10

from service.measures import COVERAGE, HARD, THIN, Measure, deviation_measure, in_words, signed
from service.records.outlook import ParameterTrend, UnitOutlook
from service.words.names import PARAMETER_NAMES, day_of

LEVEL = 0.01
"""Chance that any drift is claimed for a unit that has none."""
FAR = 5.0
"""Standard uncertainties from which on a distance from the reference is beyond doubt."""
WAITS = (timedelta(days=91), timedelta(days=182), timedelta(days=365))
"""After the due date: a quarter, half a year and a year, as calibrations are put off."""


@dataclass(frozen=True)
class Wait:
    """The risk of waiting until a day."""

    day: str
    risk: str


@dataclass(frozen=True)
class NextCalibration:
    """What a unit's page says of its future."""

    tone: str
    headline: str
    reason: str
    moving: tuple[str, ...]
    """Which parameters drift or changed suddenly."""
    together: tuple[str, ...]
    """What all sensors did together."""
    waits: tuple[Wait, ...]


def next_calibration(outlook: UnitOutlook) -> NextCalibration:
    """The words of an outlook."""
    return NextCalibration(
        tone="fail" if outlook.overdue else "reference",
        headline=_headline(outlook),
        reason=outlook.reason,
        moving=_moving(outlook.trends),
        together=outlook.together,
        waits=_waits(outlook),
    )


def _headline(outlook: UnitOutlook) -> str:
    if outlook.due is None:
        return "Next calibration: not known"
    if outlook.overdue:
        return f"Calibration overdue since {day_of(outlook.due)}"
    return f"Next calibration: {day_of(outlook.due)}"


def drifts(trend: ParameterTrend, judged: int) -> bool:
    """Whether a rate counts as a drift, at the level over all parameters of the unit."""
    single: float = 1 - (1 - LEVEL) ** (1 / max(judged, 1))
    return trend.significance < single


def _moving(trends: tuple[ParameterTrend, ...]) -> tuple[str, ...]:
    found = [_drift(trend) for trend in trends if drifts(trend, len(trends))]
    found += [_jump(trend) for trend in trends if trend.step_dates]
    found += [_wandered(trend) for trend in trends if has_moved(trend) and not _is_said(trend, len(trends))]
    return tuple(found) if found or not trends else ("No parameter drifts beyond what chance explains.",)


def has_moved(trend: ParameterTrend) -> bool:
    """Whether a parameter is far from its reference: beyond its own uncertainty, and a good part of its tolerance."""
    return abs(trend.level) > max(FAR * trend.level_sigma, trend.tolerance / 2)


def _is_said(trend: ParameterTrend, judged: int) -> bool:
    return drifts(trend, judged) or bool(trend.step_dates)


def _wandered(trend: ParameterTrend) -> str:
    measure = deviation_measure(trend.kind, trend.parameter, abs(trend.level))
    moved = signed(trend.level, COVERAGE * trend.level_sigma, measure)
    allowed = in_words(trend.kind, trend.parameter, trend.tolerance)
    return f"{_place(trend)} has moved by {moved}, at no steady rate; {allowed} are allowed."


def _drift(trend: ParameterTrend) -> str:
    measure = deviation_measure(trend.kind, trend.parameter, abs(trend.rate_per_year))
    a_year = Measure(f"{measure.label} a year", measure.factor)
    rate = signed(trend.rate_per_year, COVERAGE * trend.rate_sigma, a_year)
    return f"{_place(trend)} drifts by {rate}; {in_words(trend.kind, trend.parameter, trend.tolerance)} are allowed."


def _jump(trend: ParameterTrend) -> str:
    days = " and ".join(day_of(at) for at in trend.step_dates)
    return f"{_place(trend)} changed suddenly: first seen on {days}."


def _place(trend: ParameterTrend) -> str:
    return f"{trend.sensor} {PARAMETER_NAMES[trend.parameter]}"


def _waits(outlook: UnitOutlook) -> tuple[Wait, ...]:
    if outlook.due is None or not outlook.risk:
        return ()
    days = (outlook.due, *(outlook.due + later for later in WAITS))
    return tuple(Wait(day_of(day), _percent(outlook.risk_by(day) or 0.0)) for day in days)


def _percent(risk: float) -> str:
    if risk < 0.001:
        return f"below{HARD}0.1{THIN}%"
    if risk > 0.99:
        return f"above{HARD}99{THIN}%"
    places = max(0, -floor(log10(100 * risk)))
    return f"{100 * risk:.{places}f}{THIN}%"
