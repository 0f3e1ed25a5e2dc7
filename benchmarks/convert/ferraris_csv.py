"""FAU Erlangen (imucal): the six labelled positions of a Ferraris calibration, raw counts of one wearable IMU.

Parts ``x_p`` and ``x_a`` have the specific force along +x and −x; ``x_rot`` is a full turn and is left out.
"""

from pathlib import Path

import numpy as np
import polars as pl
from polars.exceptions import PolarsError

from benchmarks.convert.contract import Converter, Document
from benchmarks.convert.documents import PER_DEGREE, columns, session, triad
from benchmarks.convert.files import expect_count, read_bytes, refuse

GRAVITY = 9.81
"""m/s², as the publication states it."""
RATE_HZ = 204.8
"""Sample rate stated by the data set."""
COUNTS = 2048 / GRAVITY
"""Counts per m/s²: 2048 per g, as the data set states."""
GYRO_COUNTS = 16.4 * PER_DEGREE
"""Counts per rad/s: 16.4 per degree per second, as the data set states."""
DIRECTION_SIGMA_DEG = 1.0
"""Error with which a box is set down on its faces by hand."""
PARTS = ("x_p", "x_a", "y_p", "y_a", "z_p", "z_a")
READINGS = ("acc_x", "acc_y", "acc_z", "gyr_x", "gyr_y", "gyr_z")
FILES = "the annotated session, a CSV file with the columns part, samples, acc_x … gyr_z"


def read(path: Path) -> pl.DataFrame:
    """The still parts in the order measured."""
    numbers = dict.fromkeys(("samples", *READINGS), pl.Float64)
    try:
        table = pl.read_csv(read_bytes(path), schema_overrides={"part": pl.String, **numbers})
    except (PolarsError, UnicodeDecodeError, OSError) as fault:
        raise refuse(path, "file", str(fault).splitlines()[0]) from fault
    missing = [name for name in ("part", *numbers) if name not in table.columns]
    if missing:
        raise refuse(path, "header", f"lacks the columns {', '.join(missing)}")
    unusable = table.select(pl.any_horizontal(~pl.col(*numbers).is_finite().fill_null(False))).to_series()
    if unusable.any():
        raise refuse(path, "table", "holds a value that is not a finite number", row=int(unusable.arg_max() or 0) + 1)
    absent = set(PARTS) - set(table["part"].to_list())
    if absent:
        raise refuse(path, "part", f"lacks the positions {', '.join(sorted(absent))}")
    return table.filter(pl.col("part").is_in(PARTS)).sort("samples")


def direction(part: str) -> list[float]:
    """Unit vector of the specific force in a labelled position."""
    sign = 1.0 if part.endswith("p") else -1.0
    return [sign * (letter == part[0]) for letter in "xyz"]


def convert(paths: list[Path]) -> list[tuple[str, Document]]:
    """One annotated session → one raw session with labelled positions and their directions."""
    expect_count(paths, 1, FILES)
    still = read(paths[0])
    parts = still["part"].to_list()
    order = {part: k for k, part in enumerate(dict.fromkeys(parts))}
    directions = np.array([direction(part) for part in parts])
    sensors = triad("A", COUNTS, "count") + triad("G", GYRO_COUNTS, "count", gyro=True)
    table = {
        "position": [order[part] for part in parts],
        "time_s": (still["samples"].to_numpy() / RATE_HZ).tolist(),
        **{f"direction_{letter}": directions[:, k].tolist() for k, letter in enumerate("xyz")},
        **columns(sensors, still.select(READINGS).to_numpy()),
    }
    document = session(
        "fau-wearable",
        sensors,
        table,
        gravity=GRAVITY,
        notes="Ferraris calibration of one wearable IMU, raw counts; the six labelled positions, turns left out",
        sample_rate_hz=RATE_HZ,
        direction_sigma_deg=DIRECTION_SIGMA_DEG,
    )
    return [("ferraris-six-position.json", document)]


FERRARIS_CSV = Converter(
    name="ferraris-csv",
    description="Six labelled positions of one wearable IMU.",
    files=FILES,
    convert=convert,
)
