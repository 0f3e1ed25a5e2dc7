"""Fits the baseline simulation to a session, on a stand or in arbitrary orientations."""

from collections import defaultdict
from collections.abc import Hashable, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from estimator.applied_vector import (
    EARTH_RATE,
    SCHEDULES,
    Geometry,
    Schedule,
    elevation,
    gravity,
    stand_geometry,
    stand_vector,
    to_block,
)
from estimator.arrays import tangents
from estimator.calibration.batch import schedule
from estimator.calibration.noise import typical
from estimator.calibration.stand import solved
from estimator.calibration.stand_report import Solved
from estimator.causes.contract import Setting
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.orientations import fitted_state
from estimator.forward import input_of, measured, projected, slope
from estimator.parameters import SensorParameters, together
from estimator.session import ACCELEROMETER, GYROSCOPE, TWO_AXIS_STAND, Array, CalibrationSession

FREE = 1e3
"""Standard error of a reading that takes no part, in ranges of the sensor's readings: as if it were not there."""


def baseline_of(session: CalibrationSession, start: SensorParameters | None = None) -> Baseline:
    """The baseline simulation fitted to an averaged session, its noise as stated (or estimated where it is not).

    ``start``, of m sensors: where what the session does not observe stays; by default near the nominal values.
    """
    session = weightless(session)
    return on_stand(session, start) if session.programme == TWO_AXIS_STAND else in_orientations(session)


def weightless(session: CalibrationSession) -> CalibrationSession:
    """The session with readings that were set aside left without weight by a standard error that is finite, since
    causes are weighed by it."""
    if not session.set_aside:
        return session
    free = np.broadcast_to(FREE * np.ptp(session.readings, axis=0), session.readings.shape)
    return replace(session, standard_errors=np.where(np.isinf(session.standard_errors), free, session.standard_errors))


def readings_without(session: CalibrationSession, scale: Array, effect: Array) -> Array:
    """(R, m) the readings of a session without an ``effect`` (R, m) at the input, m/s² (rad/s), with ``scale`` (m,)."""
    pulsed = np.array([s.kind != ACCELEROMETER for s in session.sensors])
    return session.readings - effect * scale * np.where(pulsed, session.count_time or 1.0, 1.0)


def unstated_noise(session: CalibrationSession) -> Array:
    """(m,) bool, no unit: sensors for which the file states no standard errors."""
    return np.asarray(np.isnan(session.standard_errors).any(axis=0))


def on_stand(session: CalibrationSession, start: SensorParameters | None) -> Baseline:
    """Two-axis stand: the applied vector is known up to the stand's errors."""
    return seen_on_stand(session, solved([session], None if start is None else together([start])), 0)


def near(sessions: Sequence[CalibrationSession], starts: Sequence[SensorParameters]) -> list[Baseline]:
    """Baselines of sessions on a stand, each fitted from its own start; those of one schedule in one call."""
    groups: defaultdict[Hashable, list[int]] = defaultdict(list)
    baselines: dict[int, Baseline] = {}
    for k, session in enumerate(sessions):
        groups[schedule(session)].append(k)
    for members in groups.values():
        group = [sessions[k] for k in members]
        solution = solved(group, together([starts[k] for k in members]))
        baselines.update((k, seen_on_stand(sessions[k], solution, at)) for at, k in enumerate(members))
    return [baselines[k] for k in range(len(sessions))]


def seen_on_stand(session: CalibrationSession, solution: Solved, k: int) -> Baseline:
    """The baseline of the k-th of sessions that were solved together."""
    fitted, variance = solution.fitted, solution.fitted.variance[k]
    baseline = stand_baseline(session, fitted.parameters.at(k), solution.geometry, fitted.residual[k], variance)
    return with_expected_ratio(baseline)


def with_expected_ratio(baseline: Baseline) -> Baseline:
    """The baseline with what the sensors of a kind suggest of each other's noise, where the file does not state it."""
    wanted = baseline.unstated & np.isfinite(baseline.variance[0])
    if not wanted.any():
        return baseline
    ratio = typical(baseline.variance[:1], wanted[np.newaxis], baseline.setting.norm)[0] / baseline.variance[0]
    return replace(baseline, expected_ratio=np.nan_to_num(ratio))


def stand_baseline(
    session: CalibrationSession,
    parameters: SensorParameters,
    g: Geometry,
    residual: Array,
    variance: Array,
) -> Baseline:
    """The baseline at given parameters of a session on a stand.

    ``residual`` (R, m) at the input, m/s² (rad/s), and its ``variance`` (R, m), (m/s²)² ((rad/s)²).
    """
    steep = slope(parameters, g.n)
    rows, schedule = len(residual), Schedule.of(session)
    constant = [steep * projected(parameters.axis, d) for d in g.constant]
    setting = Setting(
        kinds=tuple(s.kind for s in session.sensors),
        parameters=parameters,
        n=g.n,
        norm=g.norm,
        beta=session.beta,
        flipped=session.flipped,
        d_alpha=elevation_derivative(schedule),
        d_beta=g.beta,
        time=session.time,
        switched_on=session.switched_on,
        temperature=session.temperature,
        vibration=session.vibration,
        force=force_on_stand(schedule),
        latitude=session.site.latitude or 0.0,
        flip_turn=session.flip_turn,
    )
    return Baseline(
        session=session,
        setting=setting,
        residual=residual,
        variance=variance,
        unstated=unstated_noise(session),
        constant=np.stack(constant, axis=-1) if constant else np.zeros((rows, len(session.sensors), 0)),
        constant_sigma=g.constant_sigma,
        row=(steep * projected(parameters.axis, g.beta))[..., None],
        row_sigma=np.full((rows, 1), g.beta_sigma),
    )


def planned_on_stand(session: CalibrationSession, like: Baseline) -> Baseline:
    """A session still to be measured, at the parameters and the typical noise of one that was."""
    geometry = stand_geometry(session)
    rows = len(session.readings)
    variance = np.broadcast_to(np.median(like.variance, axis=0), (rows, len(session.sensors)))
    nothing = np.zeros(variance.shape)
    return stand_baseline(session, like.parameters, geometry, nothing, variance)


@lru_cache(maxsize=SCHEDULES)
def elevation_derivative(session: Schedule) -> Array:
    """(R, m, 3) change of the applied vector, m/s² (rad/s) per rad of elevation, by central differences; read only."""
    step, change = 1e-4, {}
    for kind in set(session.kinds):
        angle = elevation(session.stand, kind)
        size = gravity(session.site) if kind == ACCELEROMETER else EARTH_RATE
        up, down = (stand_vector(angle + sign * step, session.beta) for sign in (1, -1))
        change[kind] = size * to_block((up - down) / (2 * step), session)
    derivative = np.stack([change[kind] for kind in session.kinds], axis=1)
    derivative.setflags(write=False)
    return derivative


@lru_cache(maxsize=SCHEDULES)
def force_on_stand(session: Schedule) -> Array | None:
    """(R, 3) specific force on the block, m/s², read only; None where the elevation above the horizon is not stated."""
    if session.stand.alpha is None:
        return None
    force = gravity(session.site) * to_block(stand_vector(session.stand.alpha, session.beta), session)
    force.setflags(write=False)
    return force


def in_orientations(session: CalibrationSession) -> Baseline:
    """Arbitrary orientations: the applied vector is estimated row by row; gyros at rest see no input."""
    state = fitted_state(session)
    y, _ = measured(session)
    g = gravity(session.site)
    kinds = tuple(s.kind for s in session.sensors)
    gyro = np.array([kind == GYROSCOPE for kind in kinds])
    rows, m = y.shape
    n = np.where(gyro[None, :, None], 0.0, g * state.directions[:, None, :])
    norm = np.where(gyro, EARTH_RATE, g)
    setting = Setting(
        kinds=kinds,
        parameters=state.parameters,
        n=n,
        norm=norm,
        beta=None,
        flipped=None,
        d_alpha=None,
        d_beta=None,
        time=session.time,
        switched_on=session.switched_on,
        temperature=session.temperature,
        vibration=session.vibration,
        force=g * state.directions if state.felt else None,
        latitude=session.site.latitude or 0.0,
        framed=bool(np.isfinite(state.direction_sigma).any()),
    )
    p = state.parameters
    turn = g * np.where(gyro[None, :, None, None], 0.0, tangents(state.directions)[:, None, :, :])
    sigma = np.repeat(state.direction_sigma[:, None], 2, axis=1)
    return Baseline(
        session=session,
        setting=setting,
        residual=y / p.scale - input_of(p, n),
        variance=state.variance,
        unstated=unstated_noise(session),
        constant=np.zeros((rows, m, 0)),
        constant_sigma=np.zeros(0),
        row=setting.through(turn),
        row_sigma=sigma,
    )
