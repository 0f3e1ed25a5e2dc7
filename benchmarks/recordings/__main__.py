"""Prints every table of ours beside the publications: ``… > benchmarks/results/recordings.md``; docs/recordings.md has
what follows from them."""

import sys

from benchmarks.recordings import tables
from benchmarks.recordings.gyros import gyros
from benchmarks.recordings.sets import FOLDER, folder

SECTIONS = (
    ("Residual on held-out positions, mm/s²", tables.residuals),
    ("imu-tk: Xsens MTi", tables.imu_tk),
    ("mpu9150-five: five MPU-9150", tables.mpu9150_five),
    ("ctu-mat: one triad, 49 orientations", tables.ctu),
    ("kth-mimu: held-out residual per IMU, mg", tables.kth_triads),
    ("kth-mimu: sessions of one board, each beside the one before", tables.history),
    ("Gyros at rest: held-out error before and after a cause is named", gyros),
    ("ferraris-csv: six labelled positions", tables.ferraris_table),
    ("ferraris-csv: residual of the six positions, mm/s²", tables.ferraris_residuals),
)


def main() -> int:
    """Print every table; 1 when the recordings are not there."""
    if not folder().is_dir():
        print(f"The recordings are not at {folder()}; set {FOLDER} to their folder.", file=sys.stderr)
        return 1
    print("# Real recordings: every table\n\nPrinted by `python -m benchmarks.recordings`.")
    for title, make in SECTIONS:
        print(f"\n## {title}\n\n{make()}")
    return 0


sys.exit(main())
