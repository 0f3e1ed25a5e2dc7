"""Why a unit must come back when it must, in one sentence that a technician understands."""

from collections.abc import Sequence
from datetime import datetime

from service.records.outlook import ParameterTrend
from service.words.names import PARAMETER_NAMES, day_of, month_of


def why_measure(since: datetime | None) -> str:
    """Of a unit that no session has shown: ever, or since its service."""
    return "No calibration yet." if since is None else f"Serviced on {day_of(since)}: measure it again."


def why_due(
    trends: Sequence[ParameterTrend],
    first: ParameterTrend | None,
    last: datetime,
    longest_days: float,
    *,
    is_longest: bool,
) -> str:
    """Why the unit comes back then; ``first`` is the trend that reaches its tolerance first."""
    interval = f"calibrate every {longest_days:.0f} days at least"
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
