"""How a unit or a production lot drifts unlike the others of its type, in words."""

from dataclasses import dataclass
from datetime import datetime, timedelta
from math import floor, log10

from estimator.message import say
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
from service.sessions.decision import Verdict
from service.sessions.records import StoredSession


def drift_stands_out(sensor: str, parameter: str, value: float) -> str:
    """Of one parameter of one unit; its rate in tolerances a year."""
    drift = say(
        "drifts by {value} % of its tolerance a year, unlike the other units of its type.",
        value=f"{100 * abs(value):.0f}",
    )
    return say(
        "{sensor} {parameter_names} {drift}", sensor=sensor, parameter_names=PARAMETER_NAMES[parameter], drift=drift
    )


def lot_stands_out(lot: str, unit_type: str, parameter: str) -> str:
    """Of one parameter of a lot."""
    return say(
        "Lot {lot} of {unit_type}: {parameter_names} drifts unlike that of the other units.",
        lot=lot,
        unit_type=unit_type,
        parameter_names=PARAMETER_NAMES[parameter],
    )


CHANGED = {
    "jump": "{what} has jumped between {after} and {before} by {moved}; {allowed} are allowed.",
    "drift": "{what} has been drifting since {after} by {moved}; {allowed} are allowed.",
    "aging": "{what} is aging since {after}, by {moved} in the first year and slower from then on; "
    "{allowed} are allowed.",
    "walk": "{what} has moved since {after}, at no steady rate; by {moved} so far; {allowed} are allowed.",
}


def changes_of(trend: ParameterTrend) -> tuple[str, ...]:
    """One sentence a change that chance does not explain; the temperature's last."""
    warm = trend.temperature
    followed = (_follows(trend, warm),) if warm is not None and warm.is_found else ()
    return (*(change_in_words(trend, change) for change in trend.changes), *followed)


def change_in_words(trend: ParameterTrend, change: FoundChange) -> str:
    """``A3 bias has jumped between 2 Mar 2026 and 4 May 2026 by +40 ± 3 µg; 50 µg are allowed.``"""
    rate = _sized(trend, change.size, change.sigma, "{rate} a year")
    return say(
        CHANGED[change.kind],
        what=place_of(trend),
        after=day_of(change.after),
        before=day_of(change.before),
        moved=rate if change.kind == "drift" else _sized(trend, change.size, change.sigma),
        allowed=in_words(trend.kind, trend.parameter, trend.tolerance),
    )


def place_of(trend: ParameterTrend) -> str:
    """``A3 bias``."""
    return say("{sensor} {parameter_names}", sensor=trend.sensor, parameter_names=PARAMETER_NAMES[trend.parameter])


def _follows(trend: ParameterTrend, warm: TemperatureCoefficient) -> str:
    if warm.curvature is not None:
        return say(
            "{trend} follows the temperature of the session along a curve, by {trend2} at its middle; its trend goes "
            "on without that.",
            trend=place_of(trend),
            trend2=_sized(trend, warm.value, warm.sigma, "{rate} per °C"),
        )
    return say(
        "{trend} follows the temperature of the session, by {trend2}; its trend goes on without that.",
        trend=place_of(trend),
        trend2=_sized(trend, warm.value, warm.sigma, "{rate} per °C"),
    )


def _sized(trend: ParameterTrend, size: float, sigma: float, per: str = "{rate}") -> str:
    """With U, k = 2."""
    measure = deviation_measure(trend.kind, trend.parameter, abs(size))
    return signed(size, 2 * sigma, Measure(say(per, rate=measure.label), measure.factor))


UNFIT = (Verdict.FAIL, Verdict.CONDITIONAL_FAIL)
"""Verdicts after which no date helps."""
NOTHING_DUE = "Nothing is due any more."


def reason_of(basis: DueBasis, due: datetime | None) -> str:
    """Why a unit comes back then, or waits for no date: the rule that decided, with its parts and nothing else."""
    if basis.at is None:
        return "No calibration yet."
    if basis.rule is DueRule.RISK and due is not None:
        level = f"{100 * (basis.risk or 0):.0f} %"
        chance = say("The chance that it is out of tolerance reaches {level} on {due}", level=level, due=day_of(due))
        return say("{chance}; {basis} contributes most.", chance=chance, basis=_place(basis))
    if basis.rule is DueRule.MAY_BE_OUT:
        return say("{basis} may be out of its tolerance already. Measure it again.", basis=_place(basis))
    return _since(basis, day_of(basis.at))


def _since(basis: DueBasis, day: str) -> str:
    """By a rule that names the day it starts from."""
    interval = say(
        "calibrate every {interval_days} at least", interval_days=counted(round(basis.interval_days or 0), "day")
    )
    if basis.rule is DueRule.INTERVAL:
        return say("Last calibrated on {day}; {interval}.", day=day, interval=interval)
    if basis.rule is DueRule.NO_TREND:
        return say("Last calibrated on {day}, which shows no trend yet; {interval}.", day=day, interval=interval)
    if basis.rule is DueRule.UNFIT:
        return say(
            "Found out of tolerance on {day}: adjust, repair or withdraw it, record the service and measure it again.",
            day=day,
        )
    if basis.rule is DueRule.UNDECIDED:
        return say("The session of {day} did not decide. {because}", day=day, because=basis.because)
    return say("Serviced on {day}: measure it again.", day=day)


def _place(basis: DueBasis) -> str:
    """The parameter that adds most to the risk."""
    return say(
        "{sensor} {parameter_names}", sensor=basis.sensor, parameter_names=PARAMETER_NAMES[basis.parameter or ""]
    )


def foreseen(outlook: UnitOutlook) -> str:
    """Which parameter reaches its tolerance first, and when, whatever set the date; empty where nothing is known."""
    if not outlook.trends or outlook.action is Action.NOW:
        return ""
    if outlook.reach_90 is None or outlook.parameter is None:
        return "No parameter is expected to reach its tolerance within twelve years."
    name = say("{sensor} {parameter_names}", sensor=outlook.sensor, parameter_names=PARAMETER_NAMES[outlook.parameter])
    later = say(" and as likely as not by {reach_50}", reach_50=month_of(outlook.reach_50)) if outlook.reach_50 else ""
    return say(
        "{name} reaches its tolerance with 10 % probability before {reach_90}{later}.",
        name=name,
        reach_90=month_of(outlook.reach_90),
        later=later,
    )


def calibrated(session: StoredSession) -> str:
    """Of a unit whose calibration was due."""
    return say("Calibrated on {started_at}.", started_at=day_of(session.started_at))


def was_due(due: datetime, reason: str) -> str:
    """Of a unit whose date has passed; ``reason`` is that of its date."""
    return say("Calibration was due on {due}. {reason}", due=day_of(due), reason=reason)


def needed_now(verdict: Verdict | None, *, known: bool) -> str:
    """In a table, of a unit that waits for no date."""
    if verdict in UNFIT:
        return "act now"
    return "repeat" if known else "not known"


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
