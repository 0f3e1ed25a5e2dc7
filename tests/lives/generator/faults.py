"""Faults of a file before anybody reads it: slips of single readings, sensors that fail while they are recorded, a
range that was set wrong, and the damage that loggers do to raw files. Every fault makes a new document of a sound one.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.lives.generator.kinds import Array, Random

Document = dict[str, Any]
GROSS = 0.02
"""Part of a column's range by which a reading must be off to be gross: a thousand times any noise here."""
FAILS = (0.3, 0.8)
"""Part of a recording after which a sensor fails."""
COUNTS = 16_384
"""Counts in the largest reading of a raw file that is written in counts of sixteen bits."""
NO_DATA = (-9999.0, -32768.0, 9.9e37)
"""Markers of missing data, as loggers and tables write them."""


@dataclass(frozen=True)
class Gross:
    """A document with a gross reading."""

    document: Document
    sensor: str
    rows: tuple[int, ...]
    """Rows of the wrong readings."""


def copied(document: Document) -> Document:
    """A document of its own."""
    made: Document = json.loads(json.dumps(document))
    return made


def names_of(document: Document) -> list[str]:
    """Names of its sensors."""
    return [sensor["name"] for sensor in document["sensors"]]


def columns(document: Document) -> dict[str, Array]:
    """(R,) readings of every sensor."""
    return {name: np.array(document["table"][name], dtype=float) for name in names_of(document)}


def with_columns(document: Document, changed: dict[str, Array]) -> Document:
    """A copy with other cells; NaN is an empty one."""
    made = copied(document)
    for name, cells in changed.items():
        made["table"][name] = [None if np.isnan(cell) else cell for cell in cells.tolist()]
    return made


SLIPS: dict[str, Callable[[dict[str, Array], str, int], Array]] = {
    "zero": lambda table, name, row: np.zeros(1),
    "sign": lambda table, name, row: -table[name][[row]],
    "decimal point": lambda table, name, row: table[name][[row]] / 10,
    "neighbour's column": lambda table, name, row: table[after(list(table), name)][[row]],
    "row before repeated": lambda table, name, row: table[name][[row - 1]],
    "stuck for four rows": lambda table, name, row: np.repeat(table[name][row - 1], 4),
}
"""Slips, and what is written in place of a reading, or of several, from a row on."""


def after(names: list[str], name: str) -> str:
    """The sensor beside one, of the same kind."""
    alike = [other for other in names if other[0] == name[0]]
    return alike[(alike.index(name) + 1) % len(alike)]


def gross(document: Document, slip: str, rng: Random) -> Gross:
    """A slip in a sensor and a row where it shows."""
    table, R = columns(document), len(next(iter(document["table"].values())))
    for at in rng.permutation(len(table) * (R - 4)).tolist():
        name, row = list(table)[at % len(table)], 1 + at // len(table)
        written = SLIPS[slip](table, name, row)
        off = np.abs(written - table[name][row : row + len(written)])
        if off.min() > GROSS * np.ptp(table[name]):
            cells = table[name].copy()
            cells[row : row + len(written)] = written
            return Gross(with_columns(document, {name: cells}), name, tuple(range(row, row + len(written))))
    raise ValueError(f"no reading of the document shows a slip of the kind {slip}")


FAILURES: dict[str, Callable[[Array, Array, float, Random], Array]] = {
    "step": lambda u, t, g, rng: u + 0.1 * g,
    "ramp": lambda u, t, g, rng: u + 0.1 * g * t / t[-1],
    "stuck": lambda u, t, g, rng: np.full_like(u, u[0]),
    "zero": lambda u, t, g, rng: np.zeros_like(u),
    "full-scale": lambda u, t, g, rng: np.full_like(u, 4.0 * g),
    "gain": lambda u, t, g, rng: 1.1 * u,
    "noise": lambda u, t, g, rng: u + 0.05 * g * rng.standard_normal(len(u)),
}
"""Failures of a sensor: functions of its readings since then, the time since then in rows, and the reading of 1 g."""


def failing(document: Document, failure: str, rng: Random) -> tuple[Document, str]:
    """A recording in which a sensor fails for good, and that sensor."""
    table = columns(document)
    number = int(rng.integers(len(table)))
    name, sensor = list(table)[number], document["sensors"][number]
    start = round(float(rng.uniform(*FAILS)) * len(table[name]))
    cells, one = table[name].copy(), 9.80665 * sensor["nominal_scale"]
    late = cells[start:]
    cells[start:] = FAILURES[failure](late, np.arange(len(late)) + 1.0, one, rng)
    return with_columns(document, {name: cells}), name


def scaled(document: Document, factor: float) -> Document:
    """All readings in a range that is not the one stated."""
    made = with_columns(document, {name: factor * cells for name, cells in columns(document).items()})
    for name in names_of(made):
        if f"{name}_se" in made["table"]:
            made["table"][f"{name}_se"] = [factor * cell for cell in made["table"][f"{name}_se"]]
    return made


def hot(document: Document, by: float, rng: Random) -> Document:
    """A recording in a unit warmer by so many °C, whose biases follow by some 0.1 mg a degree, each by its own."""
    table = columns(document)
    slopes = 1e-3 * rng.standard_normal(len(table))
    moved = {
        name: cells + by * slope * sensor["nominal_scale"]
        for (name, cells), slope, sensor in zip(table.items(), slopes, document["sensors"], strict=True)
    }
    made = with_columns(document, moved)
    made["table"]["temperature_c"] = [20.0 + by] * len(next(iter(table.values())))
    return made


def in_counts(document: Document) -> Document:
    """A raw file as a converter of sixteen bits writes it: the sound counterpart of all that loggers do."""
    table = columns(document)
    a_volt = COUNTS / max(float(np.abs(cells).max()) for cells in table.values())
    made = with_columns(document, {name: np.round(a_volt * cells) for name, cells in table.items()})
    for sensor in made["sensors"]:
        sensor |= {"nominal_scale": sensor["nominal_scale"] * a_volt, "reading_unit": "counts"}
    return made


def _in_samples(document: Document, rng: Random, value: Callable[[], float], *, every: bool) -> Document:
    """Another value in some samples of every sensor's own, or of all sensors at once."""
    table = columns(document)
    R = len(next(iter(table.values())))
    struck = rng.random(R) < 0.01
    for cells in table.values():
        cells[struck if every else rng.random(R) < 0.01] = value()
    return with_columns(document, table)


def _unsigned(document: Document, rng: Random) -> Document:
    return with_columns(document, {name: cells % 65_536 for name, cells in columns(document).items()})


def _no_data(document: Document, rng: Random) -> Document:
    marker = float(rng.choice(NO_DATA))
    return _in_samples(document, rng, lambda: marker, every=False)


def _zero_vectors(document: Document, rng: Random) -> Document:
    return _in_samples(document, rng, lambda: 0.0, every=True)


def _repeated(document: Document, rng: Random) -> Document:
    """One sample in ten is that before it once more, in all sensors."""
    R = len(document["table"]["time_s"])
    row = np.where(rng.random(R) < 0.1, np.maximum(np.arange(R) - 1, 0), np.arange(R))
    return with_columns(document, {name: cells[row] for name, cells in columns(document).items()})


def _timed(change: Callable[[Array, Random], Array]) -> "Sickness":
    def changed(document: Document, rng: Random) -> Document:
        return with_columns(document, {"time_s": change(np.array(document["table"]["time_s"]), rng)})

    return changed


def _rolled_over(time: Array, rng: Random) -> Array:
    """A counter that is full at a moment within the file, and begins anew."""
    full = 2.0 * time[-1]
    return np.asarray((time + full - float(rng.uniform(0.3, 0.7)) * time[-1]) % full)


def _restarted(time: Array, rng: Random) -> Array:
    row = int(rng.uniform(0.3, 0.7) * len(time))
    return np.r_[time[:row], time[row:] - time[row]]


def _no_rate(document: Document, rng: Random) -> Document:
    made = copied(document)
    del made["sample_rate_hz"]
    return made


Sickness = Callable[[Document, Random], Document]
SICKNESSES: dict[str, Sickness] = {
    "counts without sign": _unsigned,
    "no-data markers": _no_data,
    "zero vectors": _zero_vectors,
    "milliseconds under seconds": _timed(lambda time, rng: 1e3 * time),
    "clock rolled over": _timed(_rolled_over),
    "logger restarted": _timed(_restarted),
    "constant time": _timed(lambda time, rng: np.full_like(time, time[0])),
    "no rate": _no_rate,
    "readings repeated": _repeated,
}
"""Damage that loggers do to a raw file in counts."""


def sick(document: Document, sickness: str, rng: Random) -> Document:
    """A raw file in counts with one of `SICKNESSES`."""
    return SICKNESSES[sickness](in_counts(document), rng)
