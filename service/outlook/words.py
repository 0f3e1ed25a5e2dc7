"""Outlooks in words, and units and production lots whose drift differs from the others of their type."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from math import floor, log10

from estimator.message import joined, say
from estimator.wording import counted
from service.kit.measures import (
    COVERAGE,
    HARD,
    PARAMETER_NAMES,
    THIN,
    Measure,
    day_of,
    deviation_measure,
    in_words,
    month_of,
    signed,
)
from service.outlook.records import (
    Action,
    DueBasis,
    DueRule,
    FoundChange,
    ParameterTrend,
    TemperatureCoefficient,
    UnitOutlook,
)
from service.outlook.rules.histories import TrackKey
from service.sessions.decision import Verdict
from service.sessions.records import StoredSession


def drift_stands_out(sensor: str, parameter: str, value: float) -> str:
    """The drift of one parameter of a unit that stands out; its rate in tolerances a year."""
    drift = say(
        "drifts by {value} % of its tolerance a year, unlike the other units of its type.",
        value=f"{100 * abs(value):.0f}",
    )
    return say(
        "{sensor} {parameter_names} {drift}", sensor=sensor, parameter_names=PARAMETER_NAMES[parameter], drift=drift
    )


def lot_stands_out(lot: str, unit_type: str, parameter: str) -> str:
    """The drift of one parameter of a lot that stands out."""
    parts = {"lot": lot, "unit_type": unit_type, "parameter_names": PARAMETER_NAMES[parameter]}
    return say("Lot {lot} of {unit_type}: {parameter_names} drifts unlike in the other units.", **parts)


CHANGED = {
    "jump": "{what} jumped by {moved} between {after} and {before}; tolerance ±{allowed}.",
    "drift": "{what} has drifted at {moved} since {after}; tolerance ±{allowed}.",
    "aging": "{what} has aged since {after}: {moved} in the first year, then more slowly; tolerance ±{allowed}.",
    "walk": "{what} has changed by {moved} since {after}, at no steady rate; tolerance ±{allowed}.",
}


def changes_of(trend: ParameterTrend) -> tuple[str, ...]:
    """One sentence a change that chance does not explain; the temperature's last."""
    warm = trend.temperature
    followed = (_follows(trend, warm),) if warm is not None and warm.is_found else ()
    return (*(change_in_words(trend, change) for change in trend.changes), *followed)


def change_in_words(trend: ParameterTrend, change: FoundChange) -> str:
    """``A3 bias jumped by +40 ± 3 µg between 2 Mar 2026 and 4 May 2026; tolerance ±50 µg.``"""
    rate = _sized(trend, change.size, change.sigma, "{rate} a year")
    return say(
        CHANGED[change.kind],
        what=place_of(trend),
        after=day_of(change.after),
        before=day_of(change.before),
        moved=rate if change.kind == "drift" else _sized(trend, change.size, change.sigma),
        allowed=in_words(trend.kind, trend.parameter, trend.tolerance),
    )


MOST_NAMED = 6
"""Parameters, by name, before the rest are counted."""


def explained_in_words(at: datetime, parts: Sequence[tuple[TrackKey, float]]) -> str:
    """The changes of a session that a diagnosis attributes to the stand or to a cause common to sensors."""
    named = [
        say(
            "{sensor} {parameter_names} {size}",
            sensor=key.sensor,
            parameter_names=PARAMETER_NAMES[key.parameter],
            size=in_words(key.kind, key.parameter, size),
        )
        for key, size in parts[:MOST_NAMED]
    ]
    more = [say("{number} more", number=len(parts) - MOST_NAMED)] if len(parts) > MOST_NAMED else []
    return say(
        "The diagnosis of the session of {day} attributes these changes to the stand or to another shared cause, so "
        "they do not count as changes of the sensors: {parts}.",
        day=day_of(at),
        parts=joined(", ", [*named, *more]),
    )


def place_of(trend: ParameterTrend) -> str:
    """``A3 bias``."""
    return say("{sensor} {parameter_names}", sensor=trend.sensor, parameter_names=PARAMETER_NAMES[trend.parameter])


def _follows(trend: ParameterTrend, warm: TemperatureCoefficient) -> str:
    if warm.curvature is not None:
        return say(
            "{trend} depends on the temperature of the session along a curve ({trend2} at its middle); the trend is "
            "stated without this effect.",
            trend=place_of(trend),
            trend2=_sized(trend, warm.value, warm.sigma, "{rate} per °C"),
        )
    return say(
        "{trend} depends on the temperature of the session ({trend2}); the trend is stated without this effect.",
        trend=place_of(trend),
        trend2=_sized(trend, warm.value, warm.sigma, "{rate} per °C"),
    )


def _sized(trend: ParameterTrend, size: float, sigma: float, per: str = "{rate}") -> str:
    """The size with U, k = 2."""
    measure = deviation_measure(trend.kind, trend.parameter, abs(size))
    return signed(size, 2 * sigma, Measure(say(per, rate=measure.label), measure.factor))


UNFIT = (Verdict.FAIL, Verdict.CONDITIONAL_FAIL)
"""Verdicts after which no date helps."""
NOTHING_DUE = "Nothing is due."


def reason_of(basis: DueBasis, due: datetime | None) -> str:
    """The reason why a unit comes back then, or waits for no date: the rule that decided, with its parts and nothing
    else.
    """
    if basis.at is None:
        return "No calibration yet."
    if basis.rule is DueRule.RISK and due is not None:
        level = f"{100 * (basis.risk or 0):.0f} %"
        chance = say("The risk that it is out of tolerance reaches {level} on {due}", level=level, due=day_of(due))
        return say("{chance}; {basis} contributes most.", chance=chance, basis=_place(basis))
    if basis.rule is DueRule.MAY_BE_OUT:
        return say("{basis} may already be out of tolerance.", basis=_place(basis))
    return _since(basis, day_of(basis.at))


def _since(basis: DueBasis, day: str) -> str:
    interval = say(
        "calibrate at least every {interval_days}", interval_days=counted(round(basis.interval_days or 0), "day")
    )
    if basis.rule is DueRule.INTERVAL:
        return say("Last calibrated on {day}; {interval}.", day=day, interval=interval)
    if basis.rule is DueRule.NO_TREND:
        return say("Last calibrated on {day}; no trend known yet; {interval}.", day=day, interval=interval)
    if basis.rule is DueRule.UNFIT:
        return say(
            "Found out of tolerance on {day}: adjust, repair or withdraw it, record the service and measure it again.",
            day=day,
        )
    if basis.rule is DueRule.UNDECIDED:
        return say("The session of {day} is undecided. {because}", day=day, because=basis.because)
    return say("Serviced on {day}: measure it again.", day=day)


def _place(basis: DueBasis) -> str:
    """The parameter that adds most to the risk."""
    return say(
        "{sensor} {parameter_names}", sensor=basis.sensor, parameter_names=PARAMETER_NAMES[basis.parameter or ""]
    )


def foreseen(outlook: UnitOutlook) -> str:
    """The first parameter to reach its tolerance, and the date, whatever set the due date; empty where nothing is
    known.
    """
    if not outlook.trends or outlook.action is Action.NOW:
        return ""
    if outlook.reach_90 is None or outlook.parameter is None:
        return "No parameter is expected to reach its tolerance within twelve years."
    name = say("{sensor} {parameter_names}", sensor=outlook.sensor, parameter_names=PARAMETER_NAMES[outlook.parameter])
    later = say(" and as likely as not by {reach_50}", reach_50=month_of(outlook.reach_50)) if outlook.reach_50 else ""
    parts = {"name": name, "reach_90": month_of(outlook.reach_90), "later": later}
    return say("{name} reaches its tolerance with 10 % probability before {reach_90}{later}.", **parts)


def calibrated(session: StoredSession) -> str:
    """The remark on a unit whose calibration was due and is done."""
    return say("Calibrated on {started_at}.", started_at=day_of(session.started_at))


def was_due(due: datetime, reason: str) -> str:
    """The remark on a unit whose date has passed; ``reason`` is that of its date."""
    return say("Calibration was due on {date}. {reason}", date=day_of(due), reason=reason)


FAR = 5.0
"""Standard uncertainties from which on a distance from the reference is beyond doubt."""
WAITS = (timedelta(days=91), timedelta(days=182), timedelta(days=365))
"""Times of waiting from today: a quarter, half a year and a year, as calibrations are put off."""


@dataclass(frozen=True)
class Wait:
    """The risk of waiting until a day."""

    day: str
    risk: str


@dataclass(frozen=True)
class NextCalibration:
    """The outlook on a unit's page."""

    reason: str
    """The rule that set the date."""
    foreseen: str
    """First parameter to reach its tolerance; empty where nothing is known."""
    moving: tuple[str, ...]
    """Parameters that drift or changed suddenly."""
    together: tuple[str, ...]
    """Motions common to all sensors."""
    waits: tuple[Wait, ...]


def next_calibration(outlook: UnitOutlook, now: datetime) -> NextCalibration:
    """The words of an outlook, as of today."""
    return NextCalibration(
        reason=outlook.reason,
        foreseen=foreseen(outlook),
        moving=_moving(outlook.trends),
        together=outlook.together,
        waits=_waits(outlook, now),
    )


def _moving(trends: tuple[ParameterTrend, ...]) -> tuple[str, ...]:
    found = [text for trend in trends for text in changes_of(trend)]
    found += [_wandered(trend) for trend in trends if has_moved(trend) and not trend.changes]
    return tuple(found) if found or not trends else ("No parameter has changed significantly.",)


def has_moved(trend: ParameterTrend) -> bool:
    """Whether a parameter is far from its reference: beyond its uncertainty, and a good part of its tolerance."""
    return abs(trend.level) > max(FAR * trend.level_sigma, trend.tolerance / 2)


def _wandered(trend: ParameterTrend) -> str:
    measure = deviation_measure(trend.kind, trend.parameter, abs(trend.level))
    moved = signed(trend.level, COVERAGE * trend.level_sigma, measure)
    allowed = in_words(trend.kind, trend.parameter, trend.tolerance)
    parts = {"trend": place_of(trend), "change": moved, "tolerance": allowed}
    return say("{trend} has changed by {change}, at no steady rate; tolerance ±{tolerance}.", **parts)


def _waits(outlook: UnitOutlook, now: datetime) -> tuple[Wait, ...]:
    """The risks of waiting, from today on, and at the due date where that is still to come."""
    if not outlook.risk:
        return ()
    days = [now, *(now + later for later in WAITS)]
    if outlook.due is not None and outlook.due > now:
        days.append(outlook.due)
    return tuple(Wait(day_of(day), _percent(outlook.risk_by(day) or 0.0)) for day in sorted(days))


def _percent(risk: float) -> str:
    if risk < 0.001:
        return say("below{nbsp}0.1{thin_space}%", nbsp=HARD, thin_space=THIN)
    if risk > 0.99:
        return say("above{nbsp}99{thin_space}%", nbsp=HARD, thin_space=THIN)
    places = max(0, -floor(log10(100 * risk)))
    return f"{100 * risk:.{places}f}{THIN}%"
