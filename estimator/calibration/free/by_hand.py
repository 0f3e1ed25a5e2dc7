"""Gyros that were turned by hand between the rests of a raw log, in the frame that its accelerometers hold."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag

from estimator.applied_vector import gravity
from estimator.arrays import tangents, unit
from estimator.calibration.free.gyros import WEIGHTLESS
from estimator.calibration.free.knowledge import Indices, Knowledge, to_bias
from estimator.calibration.free.model import Linear, linearise
from estimator.calibration.free.schedule import Mask
from estimator.calibration.free.solve import Solution
from estimator.forward import measured
from estimator.hand_turns import RestDirections, ScatteredTurns, TurnedGyros, TurnedLog, calibrate_turned
from estimator.hand_turns.model import BIAS, ExtraNoise
from estimator.hand_turns.quiet import quiet_ends
from estimator.parameters import SensorParameters
from estimator.results import ForceAnswer, HandTurns, TurnsOutcome
from estimator.screening.gaps import ends, filled, smallest_steps, without_stray
from estimator.session import Array, CalibrationSession, RawRests
from estimator.static import Intervals, mean_errors

MOST = 1000
"""Rests that are used: an hour or two of turning by hand; their joint covariance grows with the square."""

CLOCK = 1e-3
"""Relative difference of the rate that the times say and the stated one up to which the times are believed."""

MISSING = 1.5
"""Samples that may lack in a turn by its times: less than two is the jitter of stamps."""


@dataclass(frozen=True, eq=False)
class HandGyros:
    """Knowledge of k gyros and what belongs to it. P accelerometer parameters."""

    known: Knowledge
    cross: Array
    """(5k, P) covariance with the accelerometers' parameters, SI; NaN of the quadratic terms."""
    answers: tuple[ForceAnswer | None, ...]
    """(k,) answers to force; None where they are not seen."""
    turns: HandTurns


def gyros_by_hand(
    session: CalibrationSession, solution: Solution, live: Mask, gyro: Mask
) -> HandGyros | HandTurns | None:
    """The gyros ``gyro`` (m,), by the solution of the accelerometers ``live`` (m,); where the turns give no scales and
    axes, why; None where the session is no log, or of fewer than three gyros."""
    raw = session.rests
    if np.count_nonzero(gyro) < BIAS:
        return None
    if raw is None:
        return None if session.at_ends is None else HandTurns(TurnsOutcome.AVERAGED)
    if len(raw.start) != len(session.readings):
        return None
    undetermined = HandTurns(TurnsOutcome.UNDETERMINED)
    if not (solution.knowledge.full and solution.knows_noise):
        return undetermined
    linear = linearise(solution.rows, solution.unknowns)
    log = log_of(session, raw, solution, live, gyro)
    if not (np.isfinite(log.rest).all() and not np.isnan(log.rest_sigma).any() and np.all(log.noise > 0)):
        return undetermined
    found = calibrate_turned(log, directions_of(solution, linear, len(log.start)))
    if found is None:
        return undetermined
    if isinstance(found, ScatteredTurns):
        return scattered(TurnsOutcome.SCATTERED, found.noise)
    scale = np.array([s.nominal_scale for s, is_gyro in zip(session.sensors, gyro, strict=True) if is_gyro])
    return knowledge(found, scale, common(solution, linear, live, session), session)


def scattered(outcome: TurnsOutcome, noise: ExtraNoise) -> HandTurns:
    """The use made of the turns, with their scatter."""
    return HandTurns(outcome, float(np.sqrt(noise.turns)), float(np.sqrt(noise.parities)))


def directions_of(solution: Solution, linear: Linear, R: int) -> RestDirections:
    """Directions of the first R rests with their joint covariance; ``linear`` at the solution."""
    by_parameters = turns_by_parameters(linear)[: 2 * R]
    covariance = block_diag(*linear.inverse[:R]) + by_parameters @ solution.knowledge.covariance @ by_parameters.T
    return RestDirections(solution.unknowns.directions[:R], solution.unknowns.direction_tangents[:R], covariance)


def turns_by_parameters(linear: Linear) -> Array:
    """(2R, P) change of the directions' turns, rad, with the parameters' dimensionless elements."""
    turns = -linear.inverse @ np.swapaxes(linear.coupling, 1, 2)
    return np.asarray(turns.reshape(-1, turns.shape[-1]))


def common(solution: Solution, linear: Linear, live: Mask, session: CalibrationSession) -> Array:
    """(2R, P) covariance of the directions' turns with the accelerometers' parameters, SI."""
    g, unknowns = gravity(session.site), solution.unknowns
    gain = np.exp(unknowns.log_scale)
    nominal = np.array([s.nominal_scale for s, is_live in zip(session.sensors, live, strict=True) if is_live])
    p = SensorParameters(nominal * gain, g * unknowns.offset / gain, unknowns.quadratic / g, unknowns.axes)
    to_si = p.si_factors(np.full(len(gain), g))[:, None] * to_bias(unknowns.offset, gain)
    return np.asarray(turns_by_parameters(linear) @ solution.knowledge.covariance @ to_si.T)


def log_of(session: CalibrationSession, raw: RawRests, solution: Solution, live: Mask, gyro: Mask) -> TurnedLog:
    """The samples and rests as `calibrate_turned` takes them."""
    samples = measured(
        replace(session, readings=raw.readings, standard_errors=np.zeros_like(raw.readings), counts_averaged=None)
    )[0]
    sensors = [s for s, is_gyro in zip(session.sensors, gyro, strict=True) if is_gyro]
    inputs = samples[:, gyro] / np.array([s.nominal_scale for s in sensors])
    gaps = np.concatenate([[0], np.cumsum(~np.isfinite(inputs).all(axis=1))])
    inputs = filled(inputs)
    step, missing = clock(raw, raw.start[:MOST], raw.stop[:MOST])
    labelled = session.position is not None
    rests = Intervals(*quiet_ends(inputs, raw.start[:MOST], raw.stop[:MOST], step, labelled=labelled))
    calm = without_stray(replace(session, readings=inputs, sensors=tuple(sensors)), rests.start, rests.stop).readings
    sigma = mean_errors(calm, rests).alone
    weightless = measured(session)[1][:MOST, gyro] > WEIGHTLESS * np.abs([s.nominal_scale for s in sensors])
    least = smallest_steps(inputs) ** 2 / 12
    return TurnedLog(
        readings=inputs,
        force=specific_force(filled(samples[:, live]), solution, session, live),
        step=step,
        start=rests.start,
        stop=rests.stop,
        seen=(raw.start[:MOST], raw.stop[:MOST]),
        whole=(gaps[rests.start[1:]] == gaps[rests.stop[:-1]])
        & (rests.start[1:] > rests.stop[:-1])
        & ~missing
        & ~clipped(inputs, rests),
        rest=rests.means(calm),
        rest_sigma=np.where(weightless, np.inf, np.hypot(sigma, [s.bias_repeatability for s in sensors])),
        noise=np.maximum(np.median(sigma**2 * rests.samples[:, None], axis=0), np.where(np.isinf(least), 0.0, least)),
        axes=np.stack([s.nominal_axis for s in sensors]),
        latitude=session.site.latitude,
        gravity=gravity(session.site),
    )


def clipped(inputs: Array, rests: Intervals) -> Mask:
    """(R − 1,) whether a gyro stands at the end of its range in a turn between the rests; readings (N, m)."""
    at_end = ends(inputs)
    stays = at_end[2:] * at_end[1:-1] * at_end[:-2]
    count = np.concatenate([[0], np.cumsum(stays.any(axis=(1, 2)))])
    last = len(count) - 1
    return np.asarray(count[np.minimum(rests.start[1:], last)] > count[np.minimum(rests.stop[:-1], last)])


def specific_force(samples: Array, solution: Solution, session: CalibrationSession, live: Mask) -> Array:
    """(N, 3) m/s², block axes, of the accelerometers' samples (N, k), reading units, offset taken off."""
    g, unknowns = gravity(session.site), solution.unknowns
    nominal = np.array([s.nominal_scale for s, is_live in zip(session.sensors, live, strict=True) if is_live])
    along = (samples / (nominal * g) - unknowns.offset) / np.exp(unknowns.log_scale)
    return np.asarray(g * along @ np.linalg.pinv(unknowns.axes).T)


def clock(raw: RawRests, start: Array, stop: Array) -> tuple[float, Mask]:
    """Seconds from sample to sample, and (R − 1,) whether samples are missing in a turn, by the times."""
    step = 1 / raw.rate
    if raw.time is None or not np.isfinite(raw.time).all():
        return step, np.zeros(len(start) - 1, dtype=bool)
    lasting = raw.time[start[1:]] - raw.time[stop[:-1] - 1]
    missing = np.abs(lasting - step * (start[1:] - stop[:-1] + 1)) > MISSING * step
    usual = float(raw.time[-1] - raw.time[0]) / (len(raw.time) - 1)
    return (usual if abs(usual / step - 1) < CLOCK else step), missing


def knowledge(found: TurnedGyros, nominal: Array, with_directions: Array, session: CalibrationSession) -> HandGyros:
    """The gyros in SI: nominal scales (k,), reading units per rad/s; directions' covariance (2R, P), SI."""
    S, beta, G = found.p[:, :3], found.p[:, 3], found.p[:, 4:]
    size, axes = np.linalg.norm(S, axis=1), unit(S)
    k, turns = len(size), tangents(axes)
    elements, by_force = np.zeros((k, 5, k, 7)), np.zeros((k, 3, 7))
    at = np.arange(k)
    elements[at, 0, at, :3] = nominal[:, None] * axes
    elements[at, 1, at, :3] = -(beta / size**2)[:, None] * axes
    elements[at, 1, at, 3] = 1 / size
    elements[at, 3:, at, :3] = np.swapaxes(turns, 1, 2) / size[:, None, None]
    by_force[:, :, :3] = -(G / size[:, None] ** 2)[:, :, None] * axes[:, None]
    by_force[:, :, 4:] = np.eye(3) / size[:, None, None]
    J = elements.reshape(5 * k, 7 * k)
    seen = np.tile([True, True, False, True, True], k)
    covariance = np.where(np.outer(seen, seen), J @ found.covariance @ J.T, np.nan)
    cross = J @ found.by_direction @ with_directions[: found.by_direction.shape[1]]
    own = found.covariance.reshape(k, 7, k, 7)[at, :, at]
    parts = by_force @ own @ np.swapaxes(by_force, 1, 2)
    R = len(session.readings)
    known = Knowledge(
        parameters=SensorParameters(nominal * size, beta / size, np.zeros(k), axes),
        covariance=covariance,
        observable=seen.reshape(k, 5),
        known=((),) * k,
        residual=padded(found.residual / size, R),
        noise=padded(found.sigma / size, R),
        freedom=np.full(5 * k, found.freedom),
    )
    answers = tuple(ForceAnswer(G[i] / size[i], parts[i]) if found.force else None for i in range(k))
    turns_used = scattered(TurnsOutcome.USED, found.noise)
    return HandGyros(known, np.where(seen[:, None], cross, np.nan), answers, turns_used)


def padded(values: Array, R: int) -> Array:
    """Rows of values (n, k), any unit, up to R, NaN where there are fewer."""
    return np.concatenate([values, np.full((R - len(values), values.shape[1]), np.nan)])


def with_cross(everything: Knowledge, gyros: Indices, accelerometers: Indices, cross: Array) -> Knowledge:
    """Merged knowledge with the covariance (5k, P), SI, of gyros and accelerometers at such places."""
    rows, columns = (np.add.outer(5 * at, np.arange(5)).ravel() for at in (gyros, accelerometers))
    seen = everything.observable.ravel()
    block = np.where(np.outer(seen[rows], seen[columns]), cross, np.nan)
    covariance = everything.covariance.copy()
    covariance[np.ix_(rows, columns)] = block
    covariance[np.ix_(columns, rows)] = block.T
    return replace(everything, covariance=covariance)
