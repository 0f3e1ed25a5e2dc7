"""Left-overs that are no pattern of ours and still not noise: neighbours in some order resemble one another.

Theory
------
A left-over y (n,), white under noise, is weighed against courses that are smooth along an order of the rows: the
order measured, temperature, β, the sensor's own input. A course is a Gaussian process of covariance λ·G: a Wiener
process (what wanders), a Matérn process (what bends), or one of alternating sign. With G = U·diag(d)·U' and v = U'y
the Bayes factor against noise of unknown variance (Jeffreys' prior) is

    ln B = −½ Σ ln(1 + λd) − ½ n ln(Σ v²/(1 + λd) / Σ v²)

and against noise of known variance −½ Σ ln(1 + λd) + ½ Σ v² λd/(1 + λd) (Rasmussen & Williams 2006, (5.8)). It is the
mean over the orders (`USUAL`), the kernels and λ. A mean of Bayes factors has expectation one under noise, so B exceeds
1/p in no more than a share p of sound sessions (Markov); in simulation it does so in 0.08 p of them at most, of 11 to
49 rows, and `CHANCE`/B is taken as the p-value, the choice of the order included.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from estimator.diagnosis.residuals.whitened import Evidence
from estimator.session import Array

FEWEST = 6
"""Degrees of freedom of one sensor's left-over below which smoothness cannot be told from chance."""

SIGNAL = 10.0 ** np.arange(-1, 4.1, 0.5)
"""λ: energy of the course over that of the noise."""

LEFT = 0.1
"""Share of a direction's noise that must be left for it to count."""

CHANCE = 0.1
"""Share of 1/B that white noise reaches at most."""

USUAL = {"the order measured": 0.5, "temperature": 0.25, "β": 0.125, "the sensor's input": 0.125}
"""Prior share of the orders: what wanders, wanders in time."""

LENGTHS = (0.08, 0.25)
"""Share of the order's range over which a bending course keeps its value."""


@dataclass(frozen=True)
class Serial:
    """One sensor whose left-over runs smoothly along an order of its rows."""

    sensor: int
    order: str
    """The order along which it does so most."""
    evidence: float
    """ln Bayes factor against white noise."""
    ratio: float = 1.0
    """Variance of the left-over over the stated one, where it was set apart as larger."""
    excess: float = 0.0
    """ln evidence that it is larger."""

    @property
    def p_value(self) -> float:
        """Of a left-over at least as smooth and as large, were there nothing but the noise."""
        return float(min(1.0, CHANCE * np.exp(-self.evidence - self.excess)))

    @property
    def strength(self) -> float:
        """In standard errors: those of a normal deviate that weighs as much."""
        return float(np.sqrt(2 * max(self.evidence + self.excess, 0.0)))


def orders(evidence: Evidence, sensor: int) -> dict[str, Array]:
    """The orders in which a left-over may run smoothly: (R,) places in 0 … 1."""
    setting = evidence.baseline.setting
    keys = {"the order measured": np.arange(setting.rows, dtype=float), "the sensor's input": setting.a[:, sensor]}
    if setting.temperature is not None and len(np.unique(setting.temperature)) >= FEWEST:
        keys["temperature"] = setting.temperature
    if setting.beta is not None:
        keys["β"] = np.mod(setting.beta, 2 * np.pi)
    return {name: (key - key.min()) / np.ptp(key) for name, key in keys.items() if np.ptp(key) > 0}


def kernels(place: Array) -> list[Array]:
    """(R, R) covariances of courses along one order: wandering, bending, of alternating sign."""
    apart = np.sqrt(3) * np.abs(place[:, None] - place)
    bending = [(1 + apart / length) * np.exp(-apart / length) for length in LENGTHS]
    sign = (-1.0) ** np.argsort(np.argsort(place, kind="stable"), kind="stable")
    return [np.minimum(place[:, None], place), *bending, bending[-1] * np.outer(sign, sign)]


def own_covariance(evidence: Evidence, taken: Array, sensor: int) -> Array:
    """(R, R) covariance of one sensor's whitened left-over under noise. ``taken`` (n, f) as in `Search.taken`."""
    R, m = evidence.baseline.residual.shape
    rows = np.arange(R) * m + sensor
    whiten = evidence.whiten
    known = 1 - (whiten.direction[:, sensor] ** 2 * (whiten.removed == 1)).sum(axis=-1)
    used = np.concatenate([evidence.basis[rows], taken[rows]], axis=1)
    return np.asarray(np.diag(known) - used @ used.T)


def serial_structure(evidence: Evidence, left: Array, taken: Array, sensor: int, *, known: bool) -> Serial | None:
    """How much smoother than noise one sensor's left-over runs along some order; None where it is too short to say.

    ``left`` (n,) and ``taken`` (n, f) as in `Search`; ``known``: whether the noise is taken as stated.
    """
    R, m = evidence.baseline.residual.shape
    size, turn = np.linalg.eigh(own_covariance(evidence, taken, sensor))
    kept = size > LEFT
    if int(kept.sum()) < FEWEST:
        return None
    root = turn[:, kept] * np.sqrt(size[kept])
    y = (turn[:, kept] / np.sqrt(size[kept])).T @ left[: R * m].reshape(R, m)[:, sensor]
    weights = {
        name: [bayes_factor(root.T @ kernel @ root, y, known=known) for kernel in kernels(place)]
        for name, place in orders(evidence, sensor).items()
    }
    prior = np.repeat([USUAL[name] for name in weights], len(weights["the order measured"]))
    together = np.concatenate(list(weights.values())) + np.log(prior / prior.sum())
    return Serial(sensor, max(weights, key=lambda name: max(weights[name])), float(logsumexp(together)))


def bayes_factor(covariance: Array, y: Array, *, known: bool) -> float:
    """ln B of a course of some covariance (n, n) against white noise, over all `SIGNAL`."""
    d, turn = np.linalg.eigh(covariance * len(y) / max(float(np.trace(covariance)), 1e-300))
    power = (turn.T @ y) ** 2
    grown = 1 + SIGNAL[:, None] * np.maximum(d, 0.0)
    volume = -0.5 * np.log(grown).sum(axis=1)
    if known:
        fitted = 0.5 * (power * (1 - 1 / grown)).sum(axis=1)
    else:
        fitted = -0.5 * len(y) * np.log((power / grown).sum(axis=1) / power.sum())
    return float(logsumexp(volume + fitted) - np.log(len(SIGNAL)))
