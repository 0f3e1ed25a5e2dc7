"""Which changes that chance does not explain somebody must act on, beside those that are remarks in the history."""

from datetime import datetime, timedelta

from service.kit.measures import YEAR
from service.outlook.records import FoundChange, ParameterTrend, UnitOutlook
from service.types.records import UnitType

GOES_ON = ("drift", "aging", "walk")
"""Kinds of change that have not come to an end."""
A_YEAR = 1.0


def is_worth_a_flag(trend: ParameterTrend, change: FoundChange, outlook: UnitOutlook, unit_type: UnitType) -> bool:
    """Whether a change takes the share of the tolerance that its type says, or goes on and may pass the tolerance
    before the unit comes back."""
    latest, back = outlook.risk[0].at, comes_back(outlook, unit_type)
    years = max(A_YEAR, (back - latest) / YEAR)
    if taken_by(change, years) >= unit_type.flag_share * trend.tolerance:
        return True
    return change.kind in GOES_ON and trend.reach_90 is not None and trend.reach_90 <= back


def taken_by(change: FoundChange, years: float) -> float:
    """What a change takes of the tolerance, SI or relative: a jump its size, a drift what it adds in so many years,
    aging that of its first year, from which on it slows, a walk what it has come to."""
    return abs(change.size) * (years if change.kind == "drift" else 1.0)


def comes_back(outlook: UnitOutlook, unit_type: UnitType) -> datetime:
    """When the next calibration is due; where the unit waits for no date, the longest interval from the latest."""
    return outlook.due or outlook.risk[0].at + timedelta(days=unit_type.maximum_interval_days)
