"""What a unit needs next and why, in one sentence that a technician understands."""

from datetime import datetime

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
        chance = f"The chance that it is out of tolerance reaches {level} on {day_of(due)}"
        return f"{chance}; {_place(basis)} contributes most."
    if basis.rule is DueRule.MAY_BE_OUT:
        return f"{_place(basis)} may be out of its tolerance already. Measure it again."
    return _since(basis, day_of(basis.at))


def _since(basis: DueBasis, day: str) -> str:
    """By a rule that names the day it starts from."""
    interval = f"calibrate every {counted(round(basis.interval_days or 0), 'day')} at least"
    if basis.rule is DueRule.INTERVAL:
        return f"Last calibrated on {day}; {interval}."
    if basis.rule is DueRule.NO_TREND:
        return f"Last calibrated on {day}, which shows no trend yet; {interval}."
    if basis.rule is DueRule.UNFIT:
        return (
            f"Found out of tolerance on {day}: adjust, repair or withdraw it, record the service and measure it again."
        )
    if basis.rule is DueRule.UNDECIDED:
        return f"The session of {day} did not decide. {basis.because}"
    return f"Serviced on {day}: measure it again."


def _place(basis: DueBasis) -> str:
    """The parameter that adds most to the risk."""
    return f"{basis.sensor} {PARAMETER_NAMES[basis.parameter or '']}"


def foreseen(outlook: UnitOutlook) -> str:
    """Which parameter reaches its tolerance first, and when, whatever set the date; empty where nothing is known."""
    if not outlook.trends or outlook.action is Action.NOW:
        return ""
    if outlook.reach_90 is None or outlook.parameter is None:
        return "No parameter is expected to reach its tolerance within twelve years."
    name = f"{outlook.sensor} {PARAMETER_NAMES[outlook.parameter]}"
    later = f" and as likely as not by {month_of(outlook.reach_50)}" if outlook.reach_50 else ""
    return f"{name} reaches its tolerance with 10 % probability before {month_of(outlook.reach_90)}{later}."


def calibrated(session: StoredSession) -> str:
    """Of a unit whose calibration was due."""
    return f"Calibrated on {day_of(session.started_at)}."


def was_due(due: datetime, reason: str) -> str:
    """Of a unit whose date has passed; ``reason`` is that of its date."""
    return f"Calibration was due on {day_of(due)}. {reason}"


def needed_now(verdict: Verdict | None, *, known: bool) -> str:
    """In a table, of a unit that waits for no date."""
    if verdict in UNFIT:
        return "act now"
    return "repeat" if known else "not known"
