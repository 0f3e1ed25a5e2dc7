"""A table with one sensor a row, named in a column → the sensors side by side."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from estimator.screening.clock import SAMPLES
from estimator.session import ACCELEROMETER
from service.ingest.layout.grids import Grid, number_of
from service.ingest.layout.senses import SHORTEST_WORD, sense_of, words_of
from service.ingest.layout.understand import split_unit
from service.ingest.layout.vocabulary import LETTERS, TIME_WORDS

MOST = 6
"""Names of sensors in a column."""
LOOKED_AT = 1000
"""First rows in which they are looked for."""


def side_by_side(grid: Grid) -> Grid:
    """The table with the readings of every kind of sensor in columns of their own, each at the time nearest to the row
    of the first kind, or else in their order; the table itself where no column names kinds."""
    found = next(((k, names) for k in range(len(grid.columns)) if (names := _sensors(grid, k))), None)
    if found is None or any(_kind(heading) for heading in grid.headings):
        return grid
    place, names = found
    rows = {
        name: np.array([j for j, cell in enumerate(grid.columns[place]) if cell == name and j not in grid.skipped])
        for name in names
    }
    others = [k for k in range(len(grid.columns)) if k != place]
    clock = next((k for k in others if set(words_of(grid.headings[k])) & set(TIME_WORDS)), None)
    times = None if clock is None else _numbers(grid, clock)
    base = rows[names[0]]
    headings, columns = [], []
    for k in others:
        is_read = k != clock and bool(np.isfinite(_numbers(grid, k)[base]).all())
        for name in names if is_read else names[:1]:
            headings.append(f"{name} {grid.headings[k]}" if is_read else grid.headings[k])
            columns.append([grid.columns[k][j] for j in _beside(base, rows[name], times)])
    following = None if grid.following is None else int((base < grid.following).sum())
    first, share = int(grid.taken.get("first_row", 1)), len(base) / max(len(grid.columns[place]), 1)
    return replace(
        grid, headings=tuple(headings), columns=tuple(columns), skipped=frozenset(), following=following,
        unseen=round(share * grid.unseen), lines=tuple((base + first).tolist()),
    )  # fmt: skip


def _sensors(grid: Grid, place: int) -> list[str]:
    """Names of sensors in a column, accelerometers first; none where it names something else."""
    cells = grid.columns[place][:LOOKED_AT]
    if len(cells) < SAMPLES or len(set(cells)) > MOST or not all(isinstance(cell, str) for cell in cells):
        return []
    counts = Counter(str(cell) for cell in grid.columns[place])
    named = [
        (kind, name)
        for name in counts
        if len(name) >= SHORTEST_WORD and counts[name] >= SAMPLES and (kind := _kind(f"{name} x")) in LETTERS
    ]
    names = [name for _, name in sorted(named)]
    return names if len(counts) > 1 and named and min(named)[0] == ACCELEROMETER else []


def _kind(heading: str) -> str | None:
    sense = sense_of(*split_unit(heading))
    return None if sense is None else sense.kind


def _numbers(grid: Grid, place: int) -> NDArray[np.float64]:
    """Numbers of a column, NaN where there is none."""
    decimal = str(grid.taken.get("decimal", "."))
    found: Sequence[float | None] = [number_of(cell, decimal) for cell in grid.columns[place]]
    return np.array([np.nan if number is None else number for number in found])


def _beside(base: NDArray[np.int64], own: NDArray[np.int64], times: NDArray[np.float64] | None) -> NDArray[np.int64]:
    """The row of a sensor beside each row of the first one."""
    if times is None or not np.isfinite(times[base]).all() or not np.isfinite(times[own]).all():
        return own[np.minimum(np.arange(len(base)), len(own) - 1)]
    order = own[np.argsort(times[own], kind="stable")]
    after = np.clip(np.searchsorted(times[order], times[base]), 1, len(order) - 1)
    is_before = times[base] - times[order[after - 1]] <= times[order[after]] - times[base]
    return np.where(is_before, order[after - 1], order[after])
