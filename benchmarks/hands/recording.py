"""The gyros of imu_tk's Xsens recording: ours, imu_tk's way of fitting, and the factory's, on turns that took no part.

imu_tk's way is its objective, written anew from the publication: the sum of squares of what every turn misses, not
weighed, with the zero from the first rest and nine numbers of a matrix. Rests, directions and integration are ours for
all.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from benchmarks.convert.imu_tk import GYRO_COUNTS, HALF_RANGE, convert
from benchmarks.hands.world import Array
from benchmarks.recordings.sets import FOLDER, folder
from estimator import read_session
from estimator.applied_vector import gravity
from estimator.arrays import nearest_turn, unit
from estimator.calibration.calibrate import averaged
from estimator.calibration.free import accelerometer_rows, solve
from estimator.calibration.free.by_hand import directions_of, log_of
from estimator.calibration.free.excess import explained
from estimator.calibration.free.model import linearise
from estimator.calibration.free.schedule import classified
from estimator.hand_turns import RestDirections, TurnedGyros, TurnedLog, calibrate_turned
from estimator.hand_turns.model import BIAS, ExtraNoise, missed, turned, upright, weights
from estimator.session import CalibrationSession

FOLDS = 5
FACTORY_SCALE = np.array([4778.0, 4758.0, 4766.0])
FACTORY_OFFSET = np.array([32768.0, 32466.0, 32485.0])
FACTORY_AXES = np.array([[1.00, -0.01, -0.02], [0.00, 1.00, 0.04], [-0.01, 0.01, 1.00]])
FACTORY_FORCE = np.array([[1.00, 0.00, -0.01], [0.01, 1.00, 0.01], [0.02, 0.01, 1.00]])
"""Datasheet of the unit, as printed by `calibrate.m` of the publication's authors."""


@dataclass(frozen=True, eq=False)
class Recorded:
    """The recording, prepared for a fit of the gyros."""

    session: CalibrationSession
    log: TurnedLog
    rests: RestDirections

    def without(self, fold: int) -> TurnedLog:
        """The log without every fifth turn."""
        kept = np.arange(len(self.log.whole)) % FOLDS != fold
        return replace(self.log, whole=self.log.whole & kept)

    def only(self, fold: int) -> TurnedLog:
        """The turns that `without` leaves out."""
        return replace(self.log, whole=self.log.whole & ~self.without(fold).whole)


def recorded() -> Recorded:
    """The recording; FileNotFoundError where it is not there."""
    from_files = folder() / "imu-tk-xsens-mti"
    if not from_files.is_dir():
        raise FileNotFoundError(f"the recordings are not at {folder()}; set {FOLDER} to their folder")
    [(_, document)] = convert([from_files / "xsens_acc.mat", from_files / "xsens_gyro.mat"])
    rows = averaged(read_session(document))
    live, _, gyro = classified(rows)
    accelerometers, stated = accelerometer_rows(rows, live, gravity(rows.site))
    solution = explained(solve(accelerometers, stated, quadratic=False))
    assert rows.rests is not None
    log = log_of(rows, rows.rests, solution, live, gyro)
    return Recorded(rows, log, directions_of(solution, linearise(solution.rows, solution.unknowns), len(log.start)))


def misses(log: TurnedLog, rests: RestDirections, p: Array) -> Array:
    """(2T,) rad by which whole turns miss the next rest."""
    split = weights(p[:, :BIAS], log.noise)
    went = turned(log, p, split)
    return missed(log, upright(rests, went.lean), went, split.W, ExtraNoise(np.zeros(len(p)))).residual


def with_zero(S: Array, beta: Array) -> Array:
    """(3, 7) p without answer to force."""
    return np.column_stack([S, beta, np.zeros((3, 3))])


def as_imu_tk(log: TurnedLog, rests: RestDirections) -> Array:
    """(3, 7) p of least squares of the turns."""

    def of(S: Array) -> Array:
        """Misses of the turns, rad, under S (9,)."""
        return misses(log, rests, with_zero(S.reshape(3, 3), log.rest[0]))

    return with_zero(least_squares(of, np.eye(3).ravel()).x.reshape(3, 3), log.rest[0])


def ours(log: TurnedLog, rests: RestDirections) -> Array:
    """(3, 7) p of greatest likelihood."""
    found = calibrate_turned(log, rests)
    assert isinstance(found, TurnedGyros)
    return found.p


def factory() -> Array:
    """(3, 7) p of the datasheet, in the frame in which the accelerometers' axes show no net turn."""
    turn = nearest_turn(unit(FACTORY_FORCE), np.eye(3))
    S = FACTORY_SCALE[:, None] * unit(FACTORY_AXES) @ turn.T / GYRO_COUNTS
    return with_zero(S, (FACTORY_OFFSET - HALF_RANGE) / GYRO_COUNTS)


def in_counts(p: Array) -> Array:
    """(12,) scale factors, counts/(rad/s), zeros, counts, and components of the axes across, mrad."""
    size = np.linalg.norm(p[:, :BIAS], axis=1)
    across = 1e3 * (p[:, :BIAS] / size[:, None])[~np.eye(3, dtype=bool)]
    return np.concatenate([GYRO_COUNTS * size, GYRO_COUNTS * p[:, BIAS] + HALF_RANGE, across])


NAMES = (
    *(f"scale {i}, counts/(rad/s)" for i in "xyz"),
    *(f"zero {i}, counts" for i in "xyz"),
    *(f"axis {i} along {j}, mrad" for i in "xyz" for j in "xyz" if i != j),
)


def table() -> str:
    """The results side by side, and what held-out turns miss."""
    known = recorded()
    log, rests = known.log, known.rests
    found = calibrate_turned(log, rests)
    assert isinstance(found, TurnedGyros)
    J = np.column_stack([(in_counts(found.p + h) - in_counts(found.p - h)) / 2e-6 for h in small_steps()])
    U = 2 * np.sqrt(np.diagonal(J @ found.covariance @ J.T))
    columns = [in_counts(p) for p in (factory(), as_imu_tk(log, rests), found.p)]
    lines = ["| | factory | imu_tk's way | ours | U (k = 2) |", "| --- | --- | --- | --- | --- |"]
    for name, a, b, c, u in zip(NAMES, *columns, U, strict=True):
        lines.append(f"| {name} | {a:.1f} | {b:.1f} | {c:.1f} | {u:.1f} |")
    held = [held_out(known, fit) for fit in (lambda _log, _rests: factory(), as_imu_tk, ours)]
    lines.append("| **held-out turns miss, ° rms** | " + " | ".join(f"**{h:.3f}**" for h in held) + " | |")
    chi2 = f"χ² of the turns {found.chi2:.0f} of {found.dof:.0f} degrees of freedom"
    return "\n".join([*lines, "", f"{len(rests.up)} rests, {int(log.whole.sum())} turns; {chi2} (ours)."])


def small_steps() -> Array:
    """(21, 3, 7) one element of p each."""
    return 1e-6 * np.eye(21).reshape(21, 3, 7)


def held_out(known: Recorded, fit: Callable[[TurnedLog, RestDirections], Array]) -> float:
    """Root mean square angle, °, by which the turns of each fold miss under a fit to the others."""
    squares = [
        misses(known.only(fold), known.rests, fit(known.without(fold), known.rests)) ** 2 for fold in range(FOLDS)
    ]
    return float(np.degrees(np.sqrt(2 * np.mean(np.concatenate(squares)))))
