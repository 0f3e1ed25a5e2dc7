"""papers-alignment.md with its figures; half a minute."""

from benchmarks.papers_alignment.figures import draw
from benchmarks.papers_alignment.runs import errors
from benchmarks.papers_alignment.tables import end_values, plans, prediction, rate_tables
from estimator.alignment import InertialModel

HEAD = """# Multi-position alignment: the paper beside ours

Written, with its figures, by `make papers` (`python -m benchmarks.papers`). Source: Liu, Jia, Li, Zhao, Dong, on gyro
mounting errors in single-axis rotation multi-position alignment. The method and what goes beyond the paper: [alignment
on a turntable](../../docs/methods/alignment.md)."""


def page() -> str:
    """All sections; the figures are written beside."""
    ten, turntable = errors(InertialModel.TEN), errors(InertialModel.TURNTABLE)
    draw(ten, turntable)
    return "\n\n".join((HEAD, end_values(ten, turntable), prediction(), plans(), rate_tables())) + "\n"
