"""Multi-position alignment of a block on a single-axis turntable: session → attitude, ∇, ε, E with covariance.

The table stops at two angles or more and turns about the vertical in between. Steps: the block reduced to three axes,
stops found in the table's angle, noise taken from the rest, coarse alignment from the stops' means, a strapdown from
the first stop on, and the Kalman filter on its velocity errors. Source: Liu, Jia, Li, Zhao, Dong, single-axis rotation
multi-position alignment; error model and what is new: see `sins`.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from estimator.alignment.axes import Triad, of_kind, require_alive, triad
from estimator.alignment.coarse import Coarse, coarse
from estimator.alignment.filtering import PRIOR, TABLE_SIGMA, Filtered, FilterSetting, Measured, relative, run
from estimator.alignment.levers import FARTHEST, without_lever_arms
from estimator.alignment.noise import LEAST_DENSITY, FilterNoise, at_rest
from estimator.alignment.positions import (
    Stop,
    interval,
    require_level,
    require_positions,
    require_rest,
    require_turns,
    stops,
)
from estimator.alignment.results import AlignmentCourse, AlignmentResult
from estimator.alignment.sins import EPS, NABLA, PHI, STATES, UNITS, InertialModel
from estimator.alignment.strapdown import BlockMotion, Strapdown, strapdown
from estimator.applied_vector import gravity
from estimator.arrays import eigh
from estimator.errors import ScheduleError, problem_at
from estimator.results import Fit
from estimator.session import ACCELEROMETER, GYROSCOPE, ROTATION_ALIGNMENT, Array, CalibrationSession
from estimator.significance import p_value

STEP = 1.0
"""s; the filter's step, as nearly as whole rows allow: short beside every turn and the Schuler period, long enough that
a session is a thousand steps or so."""
UNLIKELY = 1e-3
"""Probability of a larger χ² below which the covariance is enlarged: true noise is mistrusted once in a thousand."""


@dataclass(frozen=True, eq=False)
class Record:
    """A turntable session, reduced to three axes and checked, from the first stop on. R rows."""

    session: CalibrationSession
    """The session without the accelerations that accelerometers at stated positions feel in the turns."""
    first: int
    """Row of the session at which the first stop begins."""
    motion: BlockMotion
    """Motion of the block as the sensors measure it, before any bias is taken off."""
    per_step: int
    """Rows of a filter step."""
    angle: Array
    """(R,) angle of the table, rad."""
    stops: list[Stop]
    noise: FilterNoise


def align(
    session: CalibrationSession,
    *,
    model: InertialModel = InertialModel.TURNTABLE,
    mounting: tuple[float, float] = (0.0, 0.0),
    lever_arms: bool = True,
) -> AlignmentResult:
    """Align a block on a turntable and estimate its sensors' errors.

    Parameters
    ----------
    session : of programme rotation-alignment.
    model : which states are estimated.
    mounting : E_xz, E_yz as known from a rate table, rad; their effect is taken off the gyros before.
    lever_arms : whether accelerometers may stand away from the turn axis; the turntable's model alone looks for it.

    Raises
    ------
    ScheduleError : too few positions, a block that moves at a stop, rows out of step, a table out of level, gyros too
        noisy for a heading.
    """
    record = prepared(session, mounting)
    start = coarse(record.stops, record.motion, record.noise.gyro)
    computed = _computed(record, start)
    setting = _setting(record, lever_arms=lever_arms)
    measured = Measured(computed.velocity, _turned(record, computed))
    filtered = run(computed.path, setting, measured, model)
    return _result(record, start, computed, filtered, model)


def prepared(session: CalibrationSession, mounting: tuple[float, float] = (0.0, 0.0)) -> Record:
    """The session as the filter needs it; every fault of it is a ScheduleError."""
    if session.programme != ROTATION_ALIGNMENT:
        raise ScheduleError(
            [
                problem_at(
                    "programme",
                    "is {programme}; an alignment is {rotation_alignment}",
                    programme=session.programme,
                    rotation_alignment=ROTATION_ALIGNMENT,
                )
            ]
        )
    assert session.turn_angle is not None
    row = interval(session)
    require_alive(session, of_kind(session, ACCELEROMETER))
    gyros = triad(session, GYROSCOPE, row)
    rates = gyros.values - gyros.values[:, 2:] * np.array([*mounting, 0.0])
    angle = session.turn_angle
    stationary = stops(angle, row)
    require_positions(stationary)
    require_rest(stationary, rates, row)
    require_turns(stationary, angle, rates[:, 2], row)
    session = without_lever_arms(session, gyros.values[:, 2], row)
    accelerometers = triad(session, ACCELEROMETER, row)
    resting = np.concatenate([accelerometers.values[stop.first : stop.last] for stop in stationary])
    require_level(resting.mean(axis=0), gravity(session.site))
    per_step = max(round(STEP / row), 1)
    begin = stationary[0].first
    noise = _noise(stationary, gyros, accelerometers, row, per_step)
    return Record(
        session=session,
        first=begin,
        motion=BlockMotion(rates[begin:], accelerometers.values[begin:], row),
        per_step=per_step,
        angle=angle[begin:],
        stops=[Stop(stop.first - begin, stop.last - begin, stop.angle) for stop in stationary],
        noise=noise,
    )


def _noise(stationary: list[Stop], gyros: Triad, accelerometers: Triad, row: float, per_step: int) -> FilterNoise:
    """Noise of the filter's measurements: as the file states it for single rows, else from the stops' readings."""

    def means(values: Array) -> list[Array]:
        """The means (k, 3) of each stop over filter steps of values (R, 3), m/s² or rad/s."""
        parts = [values[stop.first : stop.last] for stop in stationary]
        return [part[: len(part) // per_step * per_step].reshape(-1, per_step, 3).mean(axis=1) for part in parts]

    gyro, _ = at_rest(means(gyros.values), row * per_step)
    accelerometer, sway = at_rest(means(accelerometers.values), row * per_step)
    stated = gyros.row_covariance is not None and accelerometers.row_covariance is not None
    if gyros.row_covariance is not None:
        gyro = gyros.row_covariance * row
    if accelerometers.row_covariance is not None:
        accelerometer, sway = accelerometers.row_covariance * row, 0.0
    accelerometer = accelerometer + LEAST_DENSITY["accelerometer"] ** 2 * np.eye(3)
    gyro = gyro + LEAST_DENSITY["gyro"] ** 2 * np.eye(3)
    return FilterNoise(accelerometer, gyro, float(np.sqrt(sway)), stated)


def _computed(record: Record, start: Coarse) -> Strapdown:
    """The strapdown, with the coarse biases taken off."""
    latitude = record.session.site.latitude
    assert latitude is not None
    motion = record.motion
    stop_of_row = np.full(len(motion.rates), -1)
    for number, stop in enumerate(record.stops):
        stop_of_row[stop.first : stop.last] = number
    corrected = BlockMotion(motion.rates - start.gyro_bias, motion.forces - start.accelerometer_bias, motion.row)
    return strapdown(start.attitude, corrected, latitude, stop_of_row, record.per_step)


def _setting(record: Record, *, lever_arms: bool) -> FilterSetting:
    site, stand = record.session.site, record.session.stand
    assert site.latitude is not None
    table = None if stand is None else stand.sigma.beta
    return FilterSetting(
        site.latitude,
        gravity(site),
        record.noise,
        wobble=table_wobble(record.session),
        table=table or TABLE_SIGMA,
        levers=FARTHEST**2 * np.eye(4) if lever_arms else np.zeros((4, 4)),
    )


def table_wobble(session: CalibrationSession) -> float:
    """One sigma of the turn axis' direction from stop to stop, per axis, rad."""
    wobble = None if session.stand is None else session.stand.sigma.wobble
    return TABLE_SIGMA if wobble is None else max(wobble, 1e-12)


def _turned(record: Record, computed: Strapdown) -> Array:
    """(K, 3) φ since the first stop as the turntable shows it, rad: its direction never changes."""
    steps = len(computed.attitude)
    angle = record.angle[record.per_step - 1 :: record.per_step][:steps]
    table = computed.attitude @ Rotation.from_rotvec(-angle[:, None] * [0.0, 0.0, 1.0]).as_matrix()
    first = table[np.flatnonzero(computed.path.begins)[0]]
    return np.asarray(-Rotation.from_matrix(table @ first.T).as_rotvec())


def _result(
    record: Record, start: Coarse, computed: Strapdown, filtered: Filtered, model: InertialModel
) -> AlignmentResult:
    n = model.size
    fit = _fit(record, filtered)
    estimate = filtered.last.x.copy()
    estimate[EPS] += start.gyro_bias
    estimate[NABLA] += start.accelerometer_bias[:2]
    covariance = filtered.last.P * fit.covariance_factor
    determined = np.diag(relative(filtered.last.P)) < 1
    correction = Rotation.from_rotvec(filtered.last.x[PHI]).as_matrix()
    course = AlignmentCourse(
        time=computed.path.step * np.arange(1, len(filtered.estimates) + 1),
        estimates=_totals(filtered.estimates, start),
        sigmas=filtered.sigmas,
        attitude=computed.attitude,
        innovations=filtered.innovations,
        innovation_sigmas=filtered.innovation_sigmas,
        stop=computed.path.stop,
    )
    return AlignmentResult(
        unit=record.session.unit,
        model=model.value,
        names=STATES[:n],
        units=UNITS[:n],
        estimate=estimate,
        covariance=covariance,
        observable={name: bool(seen) for name, seen in zip(STATES[2:13], determined[2:13], strict=False)},
        attitude=correction @ computed.attitude[-1],
        positions=tuple(stop.angle for stop in record.stops),
        fit=fit,
        course=course,
    )


def _totals(estimates: Array, start: Coarse) -> Array:
    """The estimates (K, n), SI, with the coarse biases that were taken off before the filter."""
    whole = estimates.copy()
    whole[:, EPS] += start.gyro_bias
    whole[:, NABLA] += start.accelerometer_bias[:2]
    return whole


def _fit(record: Record, filtered: Filtered) -> Fit:
    """Consistency of the innovations with their covariance, and the least known state."""
    n = len(filtered.last.x)
    values, vectors = eigh(relative(filtered.last.P)[2:13, 2:13])
    dof = filtered.measured - n
    chance = float(p_value(filtered.chi2, dof))
    factor = max(1.0, filtered.chi2 / dof) if chance < UNLIKELY else 1.0
    step = record.motion.row * record.per_step
    return Fit(
        chi2=filtered.chi2,
        dof=dof,
        p_value=chance if record.noise.stated else None,
        residual_rms=float(np.sqrt(np.mean(filtered.innovations**2)) / step),
        noise="stated" if record.noise.stated else "estimated",
        covariance_factor=factor,
        rank=int(np.sum(values < 1)),
        parameters=len(values),
        weakest=(STATES[2 + int(np.argmax(np.abs(vectors[:, -1])))], float(np.sqrt(values[-1]))),
        iterations=1,
        converged=bool(np.abs(filtered.last.x[PHI]).max() < PRIOR[PHI][2]),
    )
