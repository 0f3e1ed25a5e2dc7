"""Step: a long history → the points of its chart.

A mark is some eight pixels wide and a chart some three hundred: of sessions that are closer, the extremes cover the
others.
"""

from collections.abc import Iterator, Sequence

from service.outlook.rules.histories import MeasuredChange

MOST = 120
"""Changes up to which every one is drawn."""
STRETCHES = 40
"""Stretches of time, each about as wide as a mark."""
LISTED = 50
"""Newest changes that a table lists, drawn or not."""


def kept(changes: Sequence[MeasuredChange]) -> Iterator[tuple[MeasuredChange, bool]]:
    """The changes of one parameter that a chart shows or a table lists, and whether a chart does; oldest first."""
    seen, oldest = drawn(changes), len(changes) - LISTED
    return ((change, i in seen) for i, change in enumerate(changes) if i in seen or i >= oldest)


def drawn(changes: Sequence[MeasuredChange]) -> set[int]:
    """The indices of the changes of one parameter, oldest first, that a chart shows: the last one and, of every
    stretch, epoch, verdict and tolerance, the first, the lowest and the highest, by value and by the ends of the band.
    """
    if len(changes) <= MOST:
        return set(range(len(changes)))
    start, whole = changes[0].point.at, changes[-1].point.at - changes[0].point.at
    groups: dict[tuple[object, ...], list[tuple[int, float, float]]] = {}
    for i, change in enumerate(changes):
        if (value := change.value) is not None:
            point = change.point
            stretch = int(STRETCHES * ((point.at - start) / whole)) if whole else 0
            key = (stretch, change.epoch, point.verdict, point.is_reference, point.tolerance)
            groups.setdefault(key, []).append((i, value, change.expanded or 0.0))
    ends = (lambda c: c[1], lambda c: c[1] - c[2], lambda c: c[1] + c[2])
    extremes = (pick(group, key=end)[0] for group in groups.values() for end in ends for pick in (min, max))
    return {len(changes) - 1, *(group[0][0] for group in groups.values()), *extremes}
