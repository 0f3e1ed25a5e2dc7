"""Calibration with lasting effects in the model whose size a group of sessions fixed.

Theory
------
A session alone hardly sees such an effect: fitted freely it would cost more than it is worth. So what it adds at the
group's amplitude â is taken out of the readings, and the parameters' covariance grows by L·V·Lᵀ, where L is their
response to the columns X and V = diag(σ² + τ²) what is not known of the amplitude in this session. An effect that
differs every time has in each session what this one and the group tell together: with the score U and the information F
of `estimator.groups.statistics` the amplitude â + W(U − F·â) of covariance W = (F + V⁻¹)⁻¹, the posterior of N(â, V).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import hypot, isnan

import numpy as np

from estimator.calibration.calibrate import averaged, calibrate
from estimator.causes.catalogue import cause
from estimator.diagnosis.explanation.accepted import Accepted, calibrate_extended
from estimator.diagnosis.explanation.extended_model import enlarged
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.groups.candidates import candidates_of
from estimator.groups.layout import EVERY
from estimator.groups.library import library
from estimator.groups.results import GroupFinding
from estimator.least_squares import least_squares
from estimator.results import Calibration
from estimator.session import ACCELEROMETER, Array, CalibrationSession

EMPIRICAL = "empirical-term"
"""Takes the place of a cause: a term that was learned, and has no physical name."""


@dataclass(frozen=True)
class FixedEffect:
    """A lasting effect as a group of sessions found it."""

    cause: str
    sensors: tuple[str, ...]
    """`EVERY` for every sensor of the kind; none for a cause of stand or fixture."""
    kind: str
    """Kind of the sensors; empty without any."""
    amplitude: tuple[float, ...]
    """SI, sensor after sensor."""
    sigma: tuple[float, ...]
    """One sigma, SI, of the amplitude in a single session, σ and τ together; 0 where the group does not see it."""
    shape: float | None
    """Time constant, s; None where the cause has none."""
    varies: bool
    """Whether it differs every time, so that the session's own readings count."""
    words: tuple[str, ...] = ()
    """Factors that each amplitude multiplies, as in the equation of a learned term; empty for a cause."""


def fixed(finding: GroupFinding) -> FixedEffect:
    """A group's finding as the effect that its sessions have."""
    sigma = in_one_session([np.nan if s is None else s for s in finding.sigma], finding.spread)
    return FixedEffect(
        cause=finding.cause,
        sensors=finding.sensors,
        kind=finding.kind,
        amplitude=finding.amplitude,
        sigma=sigma,
        shape=finding.shape,
        varies=finding.form == "varying",
    )


def in_one_session(sigma: Sequence[float], spread: Sequence[float]) -> tuple[float, ...]:
    """One sigma of the amplitudes in a single session, SI: of their means, NaN where the group does not see one, and τ
    of each sensor in turn.
    """
    width = len(sigma) // max(1, len(spread))
    return tuple(0.0 if isnan(s) else hypot(s, spread[k // width]) for k, s in enumerate(sigma))


@dataclass(frozen=True, eq=False)
class Added:
    """Effects added to a session. q amplitudes."""

    columns: Array
    """(R, m, q) m/s² (rad/s) per unit amplitude."""
    amplitude: Array
    """(q,) SI."""
    variance: Array
    """(q,) SI²."""
    varies: Array
    """(q,) bool."""


def calibrate_with(
    session: CalibrationSession, effects: Sequence[FixedEffect], causes: Sequence[Accepted] = ()
) -> Calibration:
    """Calibrate a session with effects of known size taken out, and further causes fitted.

    Parameters
    ----------
    session : of a programme that calibrates a block.
    effects : those that this session has. Of one cause on one sensor the first counts, and none beside a fitted one.
        One that the session cannot have (no stand, no such sensor) is left out.
    causes : what is fitted in the session itself, as `calibrate_extended` does.

    Raises
    ------
    ScheduleError : the session cannot be calibrated at all.
    """
    rows = averaged(session)
    baseline = baseline_of(rows) if effects else None
    added = None if baseline is None else added_by(baseline, effects, causes)
    if baseline is None or added is None:
        return calibrate_extended(session, causes) if causes else calibrate(session)
    without, more = taken_out(baseline, added)
    plain = calibrate_extended(without, causes) if causes else calibrate(without)
    return enlarged(plain, more, baseline.parameters.axis_tangents)


def taken_out(baseline: Baseline, added: Added) -> tuple[CalibrationSession, Array]:
    """A fitted session without what effects add to its readings, and what is not known of them as covariance of the
    parameters (P, P), SI, along the tangents of the fit."""
    residuals, session = WhitenedResiduals.of(baseline), baseline.session
    value, covariance = amplitude_in(residuals, added)
    without = replace(session, readings=session.readings - in_readings(baseline, added.columns @ value))
    response = residuals.response @ residuals.whitened(added.columns)
    response = response * baseline.parameters.si_factors(baseline.setting.norm)[:, None]
    return without, response @ covariance @ response.T


def added_by(baseline: Baseline, effects: Sequence[FixedEffect], causes: Sequence[Accepted]) -> Added | None:
    """The effects that act in a session; None where it has none of them."""
    taken = {(identifier, sensor) for identifier, sensors in causes for sensor in sensors or ("",)}
    found: list[tuple[Array, Array, Array, bool]] = []
    for effect in effects:
        fitting = list(_places(baseline, effect, taken))
        taken |= {(effect.cause, sensor) for _, _, _, sensors in fitting for sensor in sensors}
        found += [(columns, value, variance, effect.varies) for columns, value, variance, _ in fitting]
    if not found:
        return None
    widths = [len(value) for _, value, _, _ in found]
    return Added(
        columns=np.concatenate([columns for columns, *_ in found], axis=-1),
        amplitude=np.concatenate([value for _, value, _, _ in found]),
        variance=np.concatenate([variance for _, _, variance, _ in found]),
        varies=np.repeat([varies for *_, varies in found], widths),
    )


def _places(
    baseline: Baseline, effect: FixedEffect, taken: set[tuple[str, str]]
) -> Iterator[tuple[Array, Array, Array, list[str]]]:
    """Columns (R, m, w), amplitude (w,), its variance (w,) and the sensors, place after place."""
    if effect.words:
        yield from _learned(baseline, effect, taken)
        return
    blocks = [(b, columns) for b, columns in candidates_of(baseline, cause(effect.cause)) if b.shape == effect.shape]
    for k, place in enumerate(effect.sensors or ("",)):
        matching = [
            (b, columns)
            for b, columns in blocks
            if (b.sensor == place or (place == EVERY and b.kind == effect.kind))
            and (effect.cause, b.sensor) not in taken
        ]
        if matching:
            part = slice(k * matching[0][0].width, (k + 1) * matching[0][0].width)
            value, sigma = np.array(effect.amplitude[part]), np.array(effect.sigma[part])
            yield np.sum([columns for _, columns in matching], axis=0), value, sigma**2, [b.sensor for b, _ in matching]


def _learned(
    baseline: Baseline, effect: FixedEffect, taken: set[tuple[str, str]]
) -> Iterator[tuple[Array, Array, Array, list[str]]]:
    """The places of a learned term; left out where this session lacks one of its factors, as a temperature."""
    sensor = effect.sensors[0] if effect.sensors else ""
    if (effect.cause, sensor) in taken or (sensor and sensor not in [s.name for s in baseline.session.sensors]):
        return
    known = {word: term.columns[..., k] for term in library(baseline, sensor) for k, word in enumerate(term.words)}
    places = [k for k, word in enumerate(effect.words) if word in known]
    if places:
        columns = np.stack([known[effect.words[k]] for k in places], axis=-1)
        yield columns, np.array(effect.amplitude)[places], np.array(effect.sigma)[places] ** 2, [sensor]


def amplitude_in(residuals: WhitenedResiduals, added: Added) -> tuple[Array, Array]:
    """(q,) amplitude in this session, SI, and its covariance (q, q), SI²."""
    covariance = np.diag(added.variance)
    varying = added.varies & (added.variance > 0)
    if not varying.any():
        return added.amplitude, covariance
    trace = residuals.trace(added.columns)
    left = residuals.z - trace @ added.amplitude
    fit = least_squares(trace[:, varying], left, prior=1 / added.variance[varying])
    value = added.amplitude.copy()
    value[varying] += fit.value
    covariance[np.ix_(varying, varying)] = fit.covariance
    return value, covariance


def in_readings(baseline: Baseline, effect: Array) -> Array:
    """(R, m) reading units of what is added at the input, (R, m) m/s² (rad/s)."""
    session = baseline.session
    pulsed = np.array([s.kind != ACCELEROMETER for s in session.sensors])
    period = np.where(pulsed, session.count_time or 1.0, 1.0)
    return np.asarray(effect * baseline.parameters.scale * period)
