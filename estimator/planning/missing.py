"""The settings of the stand, or the orientations, that a session under way still lacks.

On a two-axis stand the schedule is N equal steps of β a run, from the first β that was set; N follows from the smallest
step so far, or is stated. In arbitrary orientations it is what `rank_of_orientations` asks to add. Neither needs a fit:
where a sensor points is known well enough from its nominal axis.
"""

from dataclasses import dataclass

import numpy as np

from estimator.calibration.calibrate import averaged
from estimator.codec import Document, Form
from estimator.coverage import finite
from estimator.errors import Problem, ScheduleError
from estimator.message import say
from estimator.planning.expected import expected_sigmas, head_kind, input_noise, planned
from estimator.planning.orientations import rank_of_orientations
from estimator.planning.results import Request
from estimator.results import PARAMETERS
from estimator.session import ACCELEROMETER, TWO_AXIS_STAND, Array, CalibrationSession

SAME = 0.25
"""Largest distance from a setting, as a part of a step, at which a row belongs to it. Half a step would be another
setting's as well.
"""
MOST = 360
"""Equal steps a run: whole degrees are finer than anybody turns a head by."""
RUNS = ("direct", "flipped")
SETTINGS = Form(
    lambda settings: [{"run": run, "beta_deg": round(float(np.degrees(beta)), 9)} for run, beta in settings],
    lambda listed: tuple((setting["run"], float(np.radians(setting["beta_deg"]))) for setting in listed),
)


@dataclass(frozen=True)
class ExpectedSigma(Document, order=("sensor", "parameter", "so_far", "complete"), keys={"so_far": "sigma"}):
    """One parameter of one sensor; sigmas are total, relative for scale, SI; None where it is not observed."""

    sensor: str
    kind: str
    parameter: str
    so_far: float | None
    complete: float | None
    """Sigma with every position of the programme."""


@dataclass(frozen=True, eq=False)
class Missing(
    Document,
    format="imu-missing/1",
    order=("done", "positions", "is_complete", "settings", "directions", "unseen", "expected"),
    keys={"is_complete": "complete"},
    forms={"settings": SETTINGS},
):
    """Positions done, and those still to come."""

    done: int
    """Positions so far."""
    positions: int | None
    """Equal steps a run, on a stand."""
    settings: tuple[tuple[str, float], ...]
    """Run and β, rad, still to be set, in the order of turning; none in arbitrary orientations."""
    directions: Array
    """(k, 3) where up should point, unit vectors, block axes; none on a stand."""
    unseen: tuple[str, ...]
    """Parameters that the positions so far leave open."""
    expected: tuple["ExpectedSigma", ...] = ()
    """Sigmas of the parameters so far and at the end; on a stand only."""

    @property
    def is_complete(self) -> bool:
        """Whether nothing is to come."""
        return not self.settings and not len(self.directions)


def missing(session: CalibrationSession, positions: int | None = None, *, both_runs: bool = True) -> Missing:
    """The rows that a session so far lacks of a whole one.

    positions : equal steps a run; None: as the smallest step so far says. ``both_runs``: whether the block is flipped.

    Raises
    ------
    ScheduleError : the programme does not calibrate, or the steps say no number of positions.
    """
    rows = averaged(session)
    if rows.programme != TWO_AXIS_STAND:
        rank = rank_of_orientations(rows.sensors, pointing(rows))
        return Missing(len(rows.readings), None, (), rank.add, rank.unseen)
    assert rows.beta is not None
    assert rows.flipped is not None
    steps = positions or steps_of(rows.beta, rows.flipped)
    runs = np.array([False, True]) if both_runs else np.unique(rows.flipped)
    settings = tuple(
        setting for run in runs for setting in _unset(rows.beta[rows.flipped == run], rows.beta, steps, bool(run))
    )
    so_far = expected_sigmas(rows)[0]
    expected = _expected(rows, so_far, _complete(rows, steps, tuple(map(bool, runs))) if settings else so_far)
    return Missing(len(rows.readings), steps, settings, np.zeros((0, 3)), _open(expected), expected)


def _complete(rows: CalibrationSession, steps: int, runs: tuple[bool, ...]) -> Array:
    """(m, 4) sigmas of the whole programme, SI, relative for scale; NaN where the rows so far say no noise."""
    assert rows.stand is not None
    angle = rows.stand.alpha if head_kind(rows) == ACCELEROMETER else rows.stand.chi
    sigma = input_noise(rows)
    if angle is None or not np.isfinite(sigma).all():
        return np.full((len(rows.sensors), len(PARAMETERS)), np.nan)
    return expected_sigmas(planned(rows, angle, steps, Request(runs=runs), sigma))[0]


def steps_of(beta: Array, flipped: Array) -> int:
    """Equal steps in a whole turn that the smallest step between angles (R,), rad, of one run makes."""
    gaps = [np.diff(np.unique(np.round(np.mod(beta[flipped == run], 2 * np.pi), 9))) for run in np.unique(flipped)]
    counts = np.concatenate(gaps)
    count = 2 * np.pi / float(counts.min()) if len(counts) else np.inf
    if not count <= MOST or abs(count - round(count)) > SAME:
        text = "the steps so far are not equal parts of a turn; state the number of positions per run"
        raise ScheduleError([Problem("beta_deg", text)])
    return round(count)


def _unset(done: Array, every: Array, steps: int, flipped: bool) -> list[tuple[str, float]]:
    """Settings of a run that none of its angles (r,), rad, stands at; ``every`` (R,) begins with the first."""
    step = 2 * np.pi / steps
    wanted = np.mod(every[0] + step * np.arange(steps), 2 * np.pi)
    away = np.abs(np.angle(np.exp(1j * (wanted[:, None] - done[None, :]))))
    nearest = away.min(axis=1, initial=np.inf)
    return [(RUNS[flipped], float(beta)) for beta, far in zip(wanted, nearest, strict=True) if far > SAME * step]


def _expected(rows: CalibrationSession, so_far: Array, complete: Array) -> tuple[ExpectedSigma, ...]:
    """Sensor by sensor; both (m, 4) SI, relative for scale."""
    return tuple(
        ExpectedSigma(sensor.name, sensor.kind, parameter, finite(now), finite(later))
        for sensor, current, whole in zip(rows.sensors, so_far, complete, strict=True)
        for parameter, now, later in zip(PARAMETERS, current, whole, strict=True)
    )


def _open(expected: tuple[ExpectedSigma, ...]) -> tuple[str, ...]:
    """Parameters not observed yet, as ``A1 scale``."""
    return tuple(
        say("{sensor} {parameter}", sensor=estimate.sensor, parameter=estimate.parameter)
        for estimate in expected
        if estimate.so_far is None
    )


def pointing(rows: CalibrationSession) -> Array:
    """(R, 3) directions of the specific force, unit vectors: as stated, else by nominal axes and scale factors."""
    if rows.directions is not None and np.isfinite(rows.directions).all():
        return rows.directions
    felt = np.array([sensor.kind == ACCELEROMETER for sensor in rows.sensors])
    scale = np.array([sensor.nominal_scale for sensor in rows.sensors])[felt]
    offset = np.array([sensor.nominal_offset or 0.0 for sensor in rows.sensors])[felt]
    axes = np.stack([sensor.nominal_axis for sensor in rows.sensors])[felt]
    force = np.linalg.lstsq(axes, ((rows.readings[:, felt] - offset) / scale).T, rcond=None)[0].T
    directions: Array = force / np.linalg.norm(force, axis=1, keepdims=True)
    return directions
