"""Rivals on public recordings: imucal on its own six labelled positions, and imu_tk's cost on imu_tk's orientations.

imucal is given the whole turns as well, which its gyros need. Its accelerometers have as many unknowns as six positions
have to tell, so none can be held out: of every position the first half of the samples calibrates and the second
judges. imu_tk's cost, nine parameters by |a| − g, is minimised by `scipy.optimize.least_squares`; there positions are
held out by fives. Times are from the samples to the parameters for imucal, from averaged positions for imu_tk.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import imucal
import numpy as np
import pandas as pd

from benchmarks.convert.ferraris_csv import GRAVITY, PARTS, RATE_HZ
from benchmarks.figures import Figure, side_by_side
from benchmarks.recordings.held_out import held_out, misses
from benchmarks.recordings.sets import FILES, FOLDER, folder, logs, recordings
from benchmarks.recordings.tables import literature, ours, start_of
from benchmarks.recordings.triad import Triad, triad_of
from estimator.calibration import calibrate
from estimator.calibration.free import residual_per_freedom, tilt_response
from estimator.results import Calibration
from estimator.session import Array, CalibrationSession
from estimator.static import average

ROUNDS = 20
AXES = ["acc_x", "acc_y", "acc_z"]
UNIT = "mm/s²"

NOTE = """
Against rivals, what each reports is not the same. imucal gives scales, axes and offsets of accelerometers and gyros and
what gyros take of specific force, by half-sums and half-differences, and neither an uncertainty nor a test of the fit;
imu_tk's cost gives nine parameters. Ours gives every parameter with its covariance, from the spectrum of the rests and
how well the box was set down, and says whether the readings fit; whole turns of the gyros are not evaluated. Six
positions tell nothing about a model by themselves: all methods meet them within the scatter of the halves.
"""


def run() -> Iterator[Figure]:
    """Figures of time and residual beside both rivals."""
    if not folder().is_dir():
        raise FileNotFoundError(f"the recordings are not at {folder()}; set {FOLDER} to their folder")
    yield from against_imucal()
    yield from against_imu_tk()


def against_imucal() -> Iterator[Figure]:
    """Six labelled positions."""
    (path,) = folder().glob(FILES["ferraris-csv"])
    table = pd.read_csv(path, index_col="part").drop(columns="samples")
    (log,) = logs("ferraris-csv")
    work = "calibrate six labelled positions from their samples"
    times = side_by_side(partial(by_ours, log.session), partial(by_imucal, table), ROUNDS)
    yield Figure("rivals, imucal, time", work, "imucal", *times, "—")
    first, second = halves(np.asarray(log.session.position))
    held = average(rows(log.session, second), residual_per_freedom, tilt_response)
    found = triad_of(by_ours(rows(log.session, first)), log.triads[0]), by_imucal(first_halves(table))
    residuals = [1e3 * rms(misses([one], held.readings, log.g)) for one in found]
    work = "residual of the second halves of six rests, calibrated by the first"
    yield Figure("rivals, imucal, held out", work, "imucal", residuals[0], residuals[1], "≥ 0.9", UNIT)


def against_imu_tk() -> Iterator[Figure]:
    """Orientations of an Xsens MTi."""
    (recording,) = recordings("imu-tk")
    own, theirs = ours(recording), literature(recording, start_of(recording))
    peer, many = "imu_tk's cost by least_squares", len(recording.session.readings)
    times = side_by_side(partial(own, recording.session), partial(theirs, recording.session), ROUNDS)
    yield Figure("rivals, imu_tk, time", f"calibrate {many} averaged orientations", peer, *times, "—")
    residuals = [1e3 * rms(held_out(recording.session, recording.g, one)) for one in (own, theirs)]
    work = "residual of orientations held out by fives"
    yield Figure("rivals, imu_tk, held out", work, peer, residuals[0], residuals[1], "≥ 0.9", UNIT)


def by_imucal(table: pd.DataFrame) -> Triad:
    """imucal's accelerometers: raw = K·R·a + b."""
    regions = imucal.ferraris_regions_from_df(table)
    found = imucal.FerrarisCalibration(grav=GRAVITY).compute(regions, RATE_HZ, "a.u.", "a.u.")
    return Triad(found.K_a @ found.R_a, found.b_a, np.zeros(3))


def by_ours(log: CalibrationSession) -> Calibration:
    """Ours, from samples."""
    return calibrate(average(log, residual_per_freedom, tilt_response), quadratic=False)


def rows(session: CalibrationSession, chosen: Array) -> CalibrationSession:
    """Some samples of a log with labels."""
    assert session.position is not None
    assert session.time is not None
    assert session.directions is not None
    return replace(
        session, readings=session.readings[chosen], position=session.position[chosen], time=session.time[chosen],
        directions=session.directions[chosen],
    )  # fmt: skip


def halves(position: Array) -> tuple[Array, Array]:
    """Rows of the first and of the second half of every position."""
    parts = [np.array_split(np.flatnonzero(position == k), 2) for k in np.unique(position)]
    return np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts])


def first_halves(table: pd.DataFrame) -> pd.DataFrame:
    """The first half of a table with labels: rests by half, turns whole."""
    parts = [table.loc[name] for name in dict.fromkeys(table.index)]
    return pd.concat([part[: (len(part) + 1) // 2] if part.index[0] in PARTS else part for part in parts])


def rms(values: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))
