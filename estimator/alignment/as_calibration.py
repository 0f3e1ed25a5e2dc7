"""Alignment and rate-table results in the terms of a calibration, so that they are stored and judged like every other.

The block's axes take the place of its sensors, because an alignment sees a block of any number of sensors as three
axes: ``acc x`` and ``acc y`` with the bias ∇; ``gyro x``, ``gyro y``, ``gyro z`` with the bias ε, the first two with
the misalignments E_xz and E_yz, the third with the scale 1 + κ. What a programme does not speak of is in no key of
``observable``: it is not judged.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from estimator.alignment.results import AlignmentResult, RateTableResult
from estimator.results import Calibration, Estimate, Residuals, SensorCalibration
from estimator.session import ACCELEROMETER, GYROSCOPE, Array

NOTHING = Estimate(None, None)
"""Estimate of a parameter that the programme does not determine."""
MOST_ROWS = 120
"""Rows of innovations that are kept as residuals: enough for a chart, few enough to store."""
SETTLED = 10.0
"""Innovations of a larger sigma, in usual ones, come before the filter has settled and are left out: they
say what the prior was, not how the sensors behaved."""


@dataclass(frozen=True)
class Axis:
    """One axis of the block and which of its parameters are which states."""

    name: str
    kind: str
    states: dict[str, str]
    """Parameter → state."""


AXES = (
    Axis("acc x", ACCELEROMETER, {"bias": "nabla_x"}),
    Axis("acc y", ACCELEROMETER, {"bias": "nabla_y"}),
    Axis("gyro x", GYROSCOPE, {"bias": "eps_x", "misalignment": "E_xz"}),
    Axis("gyro y", GYROSCOPE, {"bias": "eps_y", "misalignment": "E_yz"}),
    Axis("gyro z", GYROSCOPE, {"scale": "kappa_z", "bias": "eps_z"}),
)
"""The axes that take the place of sensors; a rate table has the gyros alone."""
UNITS = {(ACCELEROMETER, "bias"): "m/s²", (GYROSCOPE, "bias"): "rad/s", (GYROSCOPE, "misalignment"): "rad"}
"""Units of the parameters of an axis; a scale, 1 + κ, has none."""


def alignment_calibration(result: AlignmentResult, rows: NDArray[np.bool_] | None = None) -> Calibration:
    """∇, ε, E and κ of an alignment; the residuals are the velocity's innovations as specific force along x and y.

    rows : (K,) steps whose innovations count; those after the filter has `settled` unless given.
    """
    axes = [_known(axis, result.names) for axis in AXES]
    value, sigma, time = _innovations(result, settled(result) if rows is None else rows)
    nothing = np.full((len(value), 3), np.nan)
    residuals = _residuals(np.hstack([value, nothing]), np.hstack([sigma, nothing]), time)
    return _calibration(f"rotation-alignment/{result.model}", result, axes, residuals, "turn axis vertical")


def rate_table_calibration(result: RateTableResult) -> Calibration:
    """E, ε and κ of a rate table; the residuals are those of every whole turn."""
    residuals = _residuals(result.residuals, result.residual_sigma, result.turn_times)
    found = _calibration("rate-table/whole-turns", result, list(AXES[2:]), residuals, "turn axis")
    return replace(found, set_aside=result.set_aside)


def _known(axis: Axis, names: tuple[str, ...]) -> Axis:
    """The axis with those parameters that the model has."""
    return Axis(axis.name, axis.kind, {p: state for p, state in axis.states.items() if state in names})


def _calibration(
    method: str, result: AlignmentResult | RateTableResult, axes: list[Axis], residuals: Residuals, gauge: str
) -> Calibration:
    states = [(axis, parameter, state) for axis in axes for parameter, state in axis.states.items()]
    places = [result.names.index(state) for _, _, state in states]
    covariance = result.covariance[np.ix_(places, places)].copy()
    unseen = [result.parameter(state).value is None for _, _, state in states]
    covariance[unseen], covariance[:, unseen] = np.nan, np.nan
    return Calibration(
        unit=result.unit,
        method=method,
        sensors=tuple(_sensor(axis, result) for axis in axes),
        names=tuple(f"{axis.name}.{parameter}" for axis, parameter, _ in states),
        units=tuple(UNITS.get((axis.kind, parameter), "1") for axis, parameter, _ in states),
        covariance=covariance,
        repeatability=covariance,
        fit=result.fit,
        residuals=residuals,
        gauge=gauge,
    )


def _sensor(axis: Axis, result: AlignmentResult | RateTableResult) -> SensorCalibration:
    estimates = {parameter: _estimate(result, parameter, state) for parameter, state in axis.states.items()}
    return SensorCalibration(
        name=axis.name,
        kind=axis.kind,
        scale=estimates.get("scale", NOTHING),
        bias=estimates["bias"],
        quadratic=NOTHING,
        axis=None,
        axis_tangents=np.eye(3)[:, :2],
        axis_covariance=np.full((2, 2), np.nan),
        observable={parameter: estimate.value is not None for parameter, estimate in estimates.items()},
        misalignment=estimates.get("misalignment"),
    )


def _estimate(result: AlignmentResult | RateTableResult, parameter: str, state: str) -> Estimate:
    """All of it differs from session to session."""
    estimate = result.parameter(state)
    value = estimate.value if estimate.value is None or parameter != "scale" else 1.0 + estimate.value
    dof = float(result.fit.dof) if result.fit.noise == "estimated" else None
    return Estimate(value, estimate.sigma, estimate.sigma, dof)


def settled(result: AlignmentResult) -> NDArray[np.bool_]:
    """(K,) whether the innovation of a step says how the sensors behaved, not what the prior was."""
    sigmas = result.course.innovation_sigmas
    return np.asarray((sigmas < SETTLED * np.median(sigmas)).all(axis=1))


def _innovations(result: AlignmentResult, included: NDArray[np.bool_]) -> tuple[Array, Array, Array]:
    """(R, 2) innovations and their sigmas as specific force along the block's x and y, m/s², and the times (R,), s."""
    course = result.course
    step = float(course.time[0])
    chosen = np.flatnonzero(included)
    level = np.pad(course.innovations[chosen], ((0, 0), (0, 1)))
    value = Rotation.from_matrix(course.attitude[chosen]).inv().apply(level)[:, :2] / step
    sigma = course.innovation_sigmas[chosen] / step
    chunk = -(-len(chosen) // MOST_ROWS)
    rows = len(chosen) // chunk

    def means(column: Array) -> Array:
        """Means over chunks of a column (K,) or (K, 2): m/s², its square, or s."""
        return column[: rows * chunk].reshape(rows, chunk, *column.shape[1:]).mean(axis=1)

    return means(value), np.sqrt(means(sigma**2) / chunk), means(course.time[chosen])


def _residuals(value: Array, sigma: Array, time: Array) -> Residuals:
    return Residuals(value=value, sigma=sigma, beta=None, flipped=None, time=time, temperature=None)
