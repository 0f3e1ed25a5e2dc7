"""A name must hold whether or not the errors are normal: a tail throws single readings far off, and nothing acts there.

Theory
------
What the names leave is distributed as Student's t with ν degrees of freedom and the scale s_ν that fits it best, with
the posterior weights

    w_ν ∝ π_ν·Π_j t_ν(r_j/s_ν)/s_ν,        r_j = z_j/√(freedom of the row)

nearly all of π on the normal law; the r_j of each sensor are divided by their root mean square, since that is for
others to judge. Under ν a name with the traces X explains, beside the others,

    T_ν = 2·max_a Σ_j [ln t_ν((z_j − X_j·a)/s_ν) − ln t_ν(z_j/s_ν)],

by iterated weights (ν + 1)/(ν + (z_j/s_ν)²) (Lange, Little and Taylor 1989). An effect that many readings show explains
nearly as much as it does under normal errors; one that rests on a reading or two gains there only
(ν + 1)·ln(1 + z²/(ν·s_ν²)). Its p-value is the mean of those of T_ν, χ² with the name's degrees of freedom, under the
weights.
"""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy.special import chdtrc, gammaln

from estimator.diagnosis.selection.ranking import conditional_p_value, extended_basis
from estimator.diagnosis.selection.search_state import LEVEL, Detection, SearchState
from estimator.session import Array

FREEDOMS = np.array([3.0, 4.0, 5.0, 6.0, 8.0, 11.0, 16.0, 32.0, np.inf])
"""ν that are weighed: below three errors have hardly a variance, beyond 32 they are as good as normal."""

NORMAL = 0.99
"""π of the normal law; the others share the rest. Readings are means of many samples, and means are nearly normal
whatever a sample is: it takes a scatter of the others that shows it to say that they are not."""

PRIOR = np.where(np.isinf(FREEDOMS), NORMAL, (1 - NORMAL) / (len(FREEDOMS) - 1))

KNOWN = 0.2
"""Degrees of freedom that a row must have for its residual to show how errors are distributed: single readings that a
name takes out have none."""

FEWEST = 20
"""Readings from which on tails are estimated at all."""

TINY = float(np.finfo(float).tiny)
"""Keeps a division by nothing finite."""

ROUNDS = 12
"""Rounds of weights; scale and amplitudes have then come to rest within a hundredth."""


@dataclass(frozen=True, eq=False)
class Tails:
    """Posterior distribution of a session's errors, by its readings."""

    weight: Array
    """(Q,) posterior of `FREEDOMS`."""
    scale: Array
    """(Q,) s_ν, in the standard errors that are taken."""

    @property
    def freedom(self) -> float:
        """ν of the largest weight; infinite for normal errors."""
        return float(FREEDOMS[int(np.argmax(self.weight))])

    @property
    def evenly(self) -> "Tails":
        """The posterior distribution for a uniform prior of ν."""
        weight = self.weight / PRIOR
        return replace(self, weight=weight / weight.sum())


def without_names_of_tails(state: SearchState) -> SearchState:
    """The state without names that readings far out in the tails of the errors explain as well, the worst first.

    They must be as rare under the tails that the readings show as under normal errors. A faint one, less rare than
    `LEVEL`, must be rare even where normal errors were no likelier beforehand than any tails.
    """
    while state.detections and (tails := tails_of(state)) is not None:
        gone = max(state.detections, key=partial(chance, state, tails))
        if chance(state, tails, gone) < LEVEL or chance(state, tails.evenly, gone) < state.level:
            break
        rest = tuple(f for f in state.detections if f is not gone)
        state = replace(
            state, detections=rest, in_tails=(*state.in_tails, gone) if gone.p_family < LEVEL else state.in_tails
        )
    return state


def chance(state: SearchState, tails: Tails, detection: Detection) -> float:
    """Family-wise p-value of a name under the tails that the readings show."""
    p = p_value(state, detection, tails)
    return conditional_p_value(detection, replace(detection.best, p_value=p), state.families)


def tails_of(state: SearchState) -> Tails | None:
    """The tails of everything that the findings leave; None where the readings are too few."""
    n = state.baseline.residual.size
    freedom = state.residuals.row_freedom[:n] - (state.attributed()[:n] ** 2).sum(axis=1)
    known = freedom > KNOWN
    if known.sum() < FEWEST:
        return None
    scaled = state.remaining[:n][known] / np.sqrt(freedom[known])
    sensor = state.residuals.sensor_of_row[:n][known]
    size = np.sqrt(np.bincount(sensor, scaled**2) / np.maximum(np.bincount(sensor), 1))[sensor]
    scaled = scaled / np.where(size > 0, size, 1.0)
    scale = np.array([scale_of(scaled, freedom) for freedom in FREEDOMS])
    logs = np.array([log_density(scaled, v, s).sum() for v, s in zip(FREEDOMS, scale, strict=True)]) + np.log(PRIOR)
    weight = np.exp(logs - logs.max())
    return Tails(weight / weight.sum(), scale)


def scale_of(residuals: Array, freedom: float) -> float:
    """s_ν of residuals (N,), in their unit."""
    square = float(np.mean(residuals**2))
    for _ in range(0 if np.isinf(freedom) else ROUNDS):
        square = float(np.mean(weights(residuals, freedom, np.sqrt(square)) * residuals**2))
    return float(np.sqrt(square))


def weights(residuals: Array, freedom: float, scale: float) -> Array:
    """(N,) weights of the residuals, dimensionless: one for normal errors."""
    if np.isinf(freedom):
        return np.ones_like(residuals)
    return np.asarray((freedom + 1) / (freedom + (residuals / scale) ** 2))


def log_density(residuals: Array, freedom: float, scale: float) -> Array:
    """(N,) ln t_ν(r/s)/s of residuals (N,)."""
    square = (residuals / scale) ** 2
    if np.isinf(freedom):
        return np.asarray(-square / 2 - np.log(scale * np.sqrt(2 * np.pi)))
    constant = gammaln((freedom + 1) / 2) - gammaln(freedom / 2) - 0.5 * np.log(freedom * np.pi) - np.log(scale)
    return np.asarray(constant - (freedom + 1) / 2 * np.log1p(square / freedom))


def p_value(state: SearchState, detection: Detection, tails: Tails) -> float:
    """p-value of a name beside the other names under the tails that the readings show."""
    others = replace(state, structures=()).attributed(without=detection)
    basis = extended_basis(others, detection.best.trace)[:, others.shape[1] :]
    remaining = state.residuals.z - others @ (others.T @ state.residuals.z)
    normal = float(((basis.T @ remaining) ** 2).sum())
    readings = np.arange(len(remaining)) < state.baseline.residual.size
    shares = [
        gained(remaining, basis, readings, (freedom, scale)) / max(normal, TINY)
        for freedom, scale in zip(FREEDOMS, tails.scale, strict=True)
    ]
    return float(tails.weight @ chdtrc(detection.best.freedom, detection.best.statistic * np.minimum(shares, 1.0)))


def gained(residuals: Array, basis: Array, readings: Array, law: tuple[float, float]) -> float:
    """T_ν of an orthonormal ``basis`` (n, q) in z (n,) of which ``readings`` (n,) follow the ``law`` (ν, s_ν);
    the others, parameters of earlier sessions, are normal."""
    amplitude = basis.T @ residuals
    if np.isinf(law[0]):
        return float(amplitude @ amplitude)
    for _ in range(ROUNDS):
        weight = np.where(readings, weights(residuals - basis @ amplitude, *law) / law[1] ** 2, 1.0)
        amplitude = np.linalg.solve((basis.T * weight) @ basis, basis.T @ (weight * residuals))
    away = residuals - basis @ amplitude
    normal = float((residuals[~readings] ** 2).sum() - (away[~readings] ** 2).sum())
    change = log_density(away[readings], *law) - log_density(residuals[readings], *law)
    return max(normal + 2 * float(change.sum()), 0.0)
