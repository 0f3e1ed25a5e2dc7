"""When a unit must come back, in words: the date, why, what moves, and the risk of waiting."""

from dataclasses import dataclass
from datetime import datetime, timedelta
from math import floor, log10

from estimator.message import say
from service.kit.measures import COVERAGE, HARD, THIN, deviation_measure, in_words, signed
from service.kit.names import day_of
from service.outlook.records import Action, ParameterTrend, UnitOutlook
from service.outlook.words.changes import changes_of, place_of
from service.outlook.words.due import foreseen

FAR = 5.0
"""Standard uncertainties from which on a distance from the reference is beyond doubt."""
WAITS = (timedelta(days=91), timedelta(days=182), timedelta(days=365))
"""From today on: a quarter, half a year and a year, as calibrations are put off."""
TONES = {Action.NOW: "fail", Action.REPEAT: "conditional-fail"}
"""Where the unit waits for no date."""


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
    """The rule that set the date."""
    foreseen: str
    """Which parameter reaches its tolerance first; empty where nothing is known."""
    moving: tuple[str, ...]
    """Which parameters drift or changed suddenly."""
    together: tuple[str, ...]
    """What all sensors did together."""
    waits: tuple[Wait, ...]


def next_calibration(outlook: UnitOutlook, now: datetime) -> NextCalibration:
    """The words of an outlook, as of today."""
    return NextCalibration(
        tone="fail" if outlook.overdue else TONES.get(outlook.action, "reference"),
        headline=_headline(outlook),
        reason=outlook.reason,
        foreseen=foreseen(outlook),
        moving=_moving(outlook.trends),
        together=outlook.together,
        waits=_waits(outlook, now),
    )


def _headline(outlook: UnitOutlook) -> str:
    if outlook.action is Action.NOW:
        return "Act now"
    if outlook.action is Action.REPEAT:
        return "Repeat the calibration"
    if outlook.due is None:
        return "Next calibration: not known"
    if outlook.overdue:
        return say("Calibration overdue since {due}", due=day_of(outlook.due))
    return say("Next calibration: {due}", due=day_of(outlook.due))


def _moving(trends: tuple[ParameterTrend, ...]) -> tuple[str, ...]:
    found = [text for trend in trends for text in changes_of(trend)]
    found += [_wandered(trend) for trend in trends if has_moved(trend) and not trend.changes]
    return tuple(found) if found or not trends else ("No parameter has changed beyond what chance explains.",)


def has_moved(trend: ParameterTrend) -> bool:
    """Whether a parameter is far from its reference: beyond its own uncertainty, and a good part of its tolerance."""
    return abs(trend.level) > max(FAR * trend.level_sigma, trend.tolerance / 2)


def _wandered(trend: ParameterTrend) -> str:
    measure = deviation_measure(trend.kind, trend.parameter, abs(trend.level))
    moved = signed(trend.level, COVERAGE * trend.level_sigma, measure)
    allowed = in_words(trend.kind, trend.parameter, trend.tolerance)
    return say(
        "{trend} has moved by {moved}, at no steady rate; {allowed} are allowed.",
        trend=place_of(trend),
        moved=moved,
        allowed=allowed,
    )


def _waits(outlook: UnitOutlook, now: datetime) -> tuple[Wait, ...]:
    """From today, and at the due date where that is still to come."""
    if not outlook.risk:
        return ()
    days = [now, *(now + later for later in WAITS)]
    if outlook.due is not None and outlook.due > now:
        days.append(outlook.due)
    return tuple(Wait(day_of(day), _percent(outlook.risk_by(day) or 0.0)) for day in sorted(days))


def _percent(risk: float) -> str:
    if risk < 0.001:
        return say("below{hard}0.1{thin}%", hard=HARD, thin=THIN)
    if risk > 0.99:
        return say("above{hard}99{thin}%", hard=HARD, thin=THIN)
    places = max(0, -floor(log10(100 * risk)))
    return f"{100 * risk:.{places}f}{THIN}%"
