"""Converts the search's elements to SI: covariance, observability, and combinations that are known only together."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, null_space

from estimator.calibration.free.gyros import GyroBiases
from estimator.calibration.free.model import predicted
from estimator.calibration.free.noise import freedom_of
from estimator.calibration.free.solve import Solution
from estimator.parameters import ELEMENTS, PLAUSIBLE, SensorParameters
from estimator.results import KnownCombination
from estimator.session import Array

Indices = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Knowledge:
    """The knowledge of m sensors. P = 5 m, R rows."""

    parameters: SensorParameters
    covariance: Array
    """(P, P) SI; NaN where not observable."""
    observable: Array
    """(m, 5) bool"""
    known: tuple[tuple[KnownCombination, ...], ...]
    """(m,)"""
    residual: Array
    """(R, m) at the input, m/s² (rad/s)."""
    noise: Array
    """(R, m) one sigma at the input, m/s² (rad/s); NaN where the session does not determine it."""
    freedom: Array
    """(P,) degrees of freedom of the variances: infinite where the noise is known, NaN where not determined."""


@dataclass(frozen=True, eq=False)
class Determined:
    """Knowledge of the elements ln K, b/g, c·g and the axis' turns of m sensors, from the orientations. P = 5 m."""

    covariance: Array
    """(P, P) dimensionless, of the part that is seen."""
    unseen: Array
    """(P, k) directions that the session does not determine, dimensionless."""
    observable: Array
    """(P,) bool."""
    certain: bool
    """Whether the noise is known, so that the covariance can be given."""


def of_accelerometers(solution: Solution, sigma: Array, scale: Array, g: float) -> Knowledge:
    """The accelerometers' parameters in SI with their covariance.

    Parameters
    ----------
    sigma : (R, m) stated or estimated noise, dimensionless.
    scale : (m,) nominal scales, which the search worked in, reading units per m/s².
    g : m/s².
    """
    unknowns, rows, m = solution.unknowns, solution.rows, len(scale)
    gain = np.exp(unknowns.log_scale)
    parameters = SensorParameters(scale * gain, g * unknowns.offset / gain, unknowns.quadratic / g, unknowns.axes)
    T = to_bias(unknowns.offset, gain)
    covariance = T @ solution.knowledge.covariance @ T.T
    unseen = T @ solution.knowledge.unseen
    observable = observed(covariance, unseen, np.linalg.norm(solution.knowledge.basis, axis=1) > 0)
    factors = parameters.si_factors(np.full(m, g))
    certain = solution.knows_noise
    determined = Determined(covariance, unseen, observable, certain)
    known = tuple(combinations(i, parameters, determined, factors) for i in range(m))
    given = np.outer(observable, observable) & certain
    return Knowledge(
        parameters=parameters,
        covariance=np.where(given, covariance * np.outer(factors, factors), np.nan),
        observable=observable.reshape(m, 5),
        known=known,
        residual=(rows.y - predicted(unknowns)) * (g / gain),
        noise=np.where(certain, sigma * (g / gain), np.nan),
        freedom=freedom_of(solution, T),
    )


def to_bias(offset: Array, gain: Array) -> Array:
    """(5 m, 5 m) transformation of the search's elements to ln K, b/g, c·g and the axis' turns: b/g = o·exp(−λ).

    offset, gain : (m,) o and exp(λ), dimensionless.
    """
    T = np.eye(5 * len(offset))
    bias = 5 * np.arange(len(offset)) + 1
    T[bias, bias] = 1 / gain
    T[bias, bias - 1] = -offset / gain
    return T


def observed(covariance: Array, unseen: Array, free: Array) -> Array:
    """(P,) bool: free, and no unseen direction of plausible size moves it by more than its own sigma.

    covariance : (P, P); unseen : (P, k) directions; both dimensionless. free : (P,) bool, whether it may move.
    An axis is observed with both its turns or not at all.
    """
    moved = PLAUSIBLE * np.linalg.norm(unseen, axis=1)
    result = (free & (moved <= np.sqrt(np.diagonal(covariance)))).reshape(-1, 5)
    result[:, 3:] = result[:, 3:].all(axis=1, keepdims=True)
    return result.ravel()


def combinations(i: int, p: SensorParameters, determined: Determined, factors: Array) -> tuple[KnownCombination, ...]:
    """The known combinations of sensor i's lost scale, bias and quadratic: those that no unseen direction changes.

    ``factors`` (P,) take the dimensionless elements to SI.
    """
    elements = slice(5 * i, 5 * i + 3)
    lost = 5 * i + np.flatnonzero(
        ~determined.observable[elements] & (np.linalg.norm(determined.unseen[elements], axis=1) > 0)
    )
    if len(lost) < 2:
        return ()
    values = np.array([p.scale[i], p.bias[i], p.quadratic[i]])[lost % 5]
    known = []
    for a in null_space(determined.unseen[lost].T).T:
        coefficients = a / factors[lost]
        known.append(
            KnownCombination(
                coefficients={ELEMENTS[k % 5]: float(c) for k, c in zip(lost, coefficients, strict=True)},
                value=float(coefficients @ values),
                sigma=float(np.sqrt(a @ determined.covariance[np.ix_(lost, lost)] @ a)) if determined.certain else None,
            )
        )
    return tuple(known)


def of_gyros(gyros: GyroBiases, scale: Array, axes: Array) -> Knowledge:
    """Biases, and nothing else, of k gyros: scale (k,), reading units per rad/s, and axes (k, 3) stay nominal."""
    k = len(gyros.bias)
    covariance = np.full((k, 5, k, 5), np.nan)
    covariance[:, 1, :, 1] = np.diag(gyros.sigma**2)
    observable = np.zeros((k, 5), dtype=bool)
    observable[:, 1] = True
    parameters = SensorParameters(scale, gyros.bias, np.zeros(k), axes)
    square = covariance.reshape(5 * k, 5 * k)
    square[1::5][np.isnan(gyros.freedom)] = np.nan
    freedom = np.full((k, 5), np.inf)
    freedom[:, 1] = gyros.freedom
    return Knowledge(parameters, square, observable, ((),) * k, gyros.residual, gyros.noise, freedom.ravel())


def of_nothing(readings: Array, scale: Array, axes: Array) -> Knowledge:
    """Sensors that answer to nothing: readings (R, k) of constant value, which is all that is known of them.

    readings in reading units; nominal scale (k,) per m/s² (rad/s); nominal axes (k, 3), unit vectors.
    """
    R, k = readings.shape
    zero = np.zeros(k)
    return Knowledge(
        parameters=SensorParameters(scale, zero, zero, axes),
        covariance=np.full((5 * k, 5 * k), np.nan),
        observable=np.zeros((k, 5), dtype=bool),
        known=((),) * k,
        residual=(readings - readings.mean(axis=0)) / scale,
        noise=np.broadcast_to(np.abs(readings.std(axis=0) / scale), (R, k)),
        freedom=np.full(5 * k, np.inf),
    )


def merged(parts: list[tuple[Indices, Knowledge]]) -> Knowledge:
    """Independent parts, each with the places (k,) of its sensors, as one in the session's order."""
    if len(parts) == 1:
        return parts[0][1]
    places = np.concatenate([at for at, _ in parts])
    order = np.argsort(places)
    elements = (5 * order[:, None] + np.arange(5)).ravel()
    covariance = block_diag(*(k.covariance for _, k in parts))
    observable = np.concatenate([k.observable for _, k in parts])
    flat = observable.ravel()
    covariance = np.where(np.outer(flat, flat), covariance, np.nan)
    known = [c for _, k in parts for c in k.known]

    def joined(name: str) -> Array:
        """One of the parameters (m,) or (m, 3), in its SI unit, in the session's order."""
        return np.concatenate([getattr(k.parameters, name) for _, k in parts])[order]

    return Knowledge(
        parameters=SensorParameters(joined("scale"), joined("bias"), joined("quadratic"), joined("axis")),
        covariance=covariance[np.ix_(elements, elements)],
        observable=observable[order],
        known=tuple(known[k] for k in order),
        residual=np.concatenate([k.residual for _, k in parts], axis=1)[:, order],
        noise=np.concatenate([k.noise for _, k in parts], axis=1)[:, order],
        freedom=np.concatenate([k.freedom for _, k in parts])[elements],
    )
