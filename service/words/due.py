"""What a unit needs next and why, in one sentence that a technician understands."""

from collections.abc import Sequence
from datetime import datetime

from estimator.wording import counted
from service.records.decision import Verdict
from service.records.outlook import Action, ParameterTrend
from service.records.session import StoredSession
from service.words.names import PARAMETER_NAMES, day_of, month_of

UNFIT = (Verdict.FAIL, Verdict.CONDITIONAL_FAIL)
"""Verdicts after which no date helps."""
NOTHING_DUE = "Nothing is due any more."


def why_measure(since: datetime | None) -> str:
    """Of a unit that no session has shown: ever, or since its service."""
    return "No calibration yet." if since is None else f"Serviced on {day_of(since)}: measure it again."


def was_due(due: datetime, reason: str) -> str:
    """Of a unit whose date has passed; ``reason`` is that of its date."""
    return f"Calibration was due on {day_of(due)}. {reason}"


def why_now(action: Action, last: StoredSession, reason: str) -> str:
    """Of a unit that waits for no date: found unfit, or not decided; ``reason`` is that of the forecast."""
    day = day_of(last.started_at)
    if action is Action.NOW:
        return (
            f"Found out of tolerance on {day}: adjust, repair or withdraw it, record the service and measure it again."
        )
    if last.verdict is Verdict.UNDECIDABLE:
        return f"The session of {day} did not decide. {last.reason}"
    return f"{reason} Measure it again."


def why_due(
    trends: Sequence[ParameterTrend],
    first: ParameterTrend | None,
    last: datetime,
    longest_days: float,
    *,
    is_longest: bool,
) -> str:
    """Why the unit comes back then; ``first`` is the trend that reaches its tolerance first."""
    interval = f"calibrate every {counted(round(longest_days), 'day')} at least"
    if not trends:
        return f"One session since the reference was set tells no trend; {interval}."
    if first is None or first.reach_90 is None:
        return f"No parameter is expected to reach its tolerance within twelve years; {interval}."
    name = f"{first.sensor} {PARAMETER_NAMES[first.parameter]}"
    if first.reach_90 <= last:
        return f"{name} may be out of its tolerance already."
    later = f" and as likely as not by {month_of(first.reach_50)}" if first.reach_50 else ""
    forecast = f"{name} reaches its tolerance with 10 % probability before {month_of(first.reach_90)}{later}"
    return f"{forecast}; {interval}." if is_longest else f"{forecast}."


def needed_now(verdict: Verdict | None, *, known: bool) -> str:
    """In a table, of a unit that waits for no date."""
    if verdict in UNFIT:
        return "act now"
    return "repeat" if known else "not known"
