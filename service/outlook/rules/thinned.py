"""Step: a long history → what a chart of it shows.

A mark is some eight pixels wide and a chart some three hundred: of sessions that are closer, the extremes cover the
others.
"""

from collections.abc import Sequence
from operator import attrgetter
from typing import NamedTuple

from service.outlook.rules.histories import MeasuredChange

WHOLE = 50
"""Newest changes of which every one is kept, for the table beside the chart too."""
STRETCHES = 40
"""Of time, each about as wide as a mark."""


def thinned(changes: Sequence[MeasuredChange]) -> tuple[MeasuredChange, ...]:
    """Of changes of one parameter, oldest first: the newest ones; of the others the first, the lowest and the highest,
    by value and by the ends of the band, of every stretch, epoch, verdict and tolerance."""
    old, new = changes[:-WHOLE], changes[-WHOLE:]
    if not old:
        return tuple(new)
    start, whole = old[0].point.at, new[-1].point.at - old[0].point.at
    groups: dict[tuple[object, ...], list[_Band]] = {}
    for i, change in enumerate(old):
        if (value := change.value) is not None:
            point, spread = change.point, change.expanded or 0.0
            stretch = int(STRETCHES * ((point.at - start) / whole)) if whole else 0
            key = (stretch, change.epoch, point.verdict, point.is_reference, point.tolerance)
            groups.setdefault(key, []).append(_Band(i, value, value - spread, value + spread))
    kept = {band.index for group in groups.values() for band in _extremes(group)}
    return (*(old[i] for i in sorted(kept)), *new)


class _Band(NamedTuple):
    index: int
    value: float
    lower: float
    upper: float


def _extremes(group: Sequence[_Band]) -> tuple[_Band, ...]:
    by_value, lower, upper = attrgetter("value"), attrgetter("lower"), attrgetter("upper")
    ends = min(group, key=by_value), max(group, key=by_value)
    return group[0], *ends, min(group, key=lower), max(group, key=upper)
