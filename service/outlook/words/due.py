"""What a unit needs next and why, in one sentence that a technician understands."""

from datetime import datetime

from estimator.message import say
from estimator.wording import counted
from service.kit.names import PARAMETER_NAMES, day_of, month_of
from service.outlook.records import Action, DueBasis, DueRule, UnitOutlook
from service.sessions.decision import Verdict
from service.sessions.records import StoredSession

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
