"""Autocorrelated residuals: in no pattern of ours and still not noise, because neighbours in some order are alike.

Theory
------
A residual y (n,), white under noise, is weighed against courses that are smooth along an order of the rows: the
order measured, temperature, β (in each run for itself, or together with order or temperature), the sensor's own input,
the vibration where it was recorded.
A course is a Gaussian process of covariance λ·G: a Wiener
process (what wanders), a Matérn process (what bends), or one of alternating sign. With G = U·diag(d)·U' and v = U'y
the Bayes factor against noise of unknown variance (Jeffreys' prior) is

    ln B = −½ Σ ln(1 + λd) − ½ n ln(Σ v²/(1 + λd) / Σ v²)

and against noise of known variance −½ Σ ln(1 + λd) + ½ Σ v² λd/(1 + λd) (Rasmussen & Williams 2006, (5.8)). Only
ln |I + λG| = Σ ln(1 + λd) and y'(I + λG)⁻¹y = Σ v²/(1 + λd) are needed: in a basis that begins with y and makes G
tridiagonal, both come from the pivots of I + λG, from the last to the first (Golub & Meurant 2010, Matrices, Moments
and Quadrature, 3.1). No pivot is below one. B is the
mean over the orders (`USUAL`), the kernels and λ. A mean of Bayes factors has expectation one under noise, so B exceeds
1/p in no more than a share p of sound sessions (Markov); in simulation it does so in 0.08 p of them at most, of 11 to
49 rows, and `CHANCE`/B is taken as the p-value, the choice of the order included.
"""

import numpy as np
from scipy.linalg.lapack import dsytrd

from estimator.arrays import eigh
from estimator.causes.contract import varies
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.signatures.noise import Autocorrelation
from estimator.diagnosis.signatures.wandering import log_mean
from estimator.session import Array

FEWEST = 6
"""Degrees of freedom of one sensor's residual below which smoothness cannot be distinguished from chance."""

SIGNAL = 10.0 ** np.arange(-1, 4.1, 0.5)
"""λ: energy of the course over that of the noise, from hardly visible to a course a hundred sigmas high."""

LEAST_FREE_NOISE = 0.1
"""Share of a direction's noise that must remain for it to count; less would magnify rounding and model error."""

USUAL = {
    "the order measured": 0.4,
    "temperature": 0.2,
    "β": 0.1,
    "the sensor's input": 0.1,
    "β, each run separately": 0.1,
    "β and the order measured": 0.05,
    "β and temperature": 0.05,
    "the vibration": 0.1,
}
"""Prior share of the orders, in proportion: what wanders, wanders in time. Those that a session lacks have none."""

ROUND = (0.4, 1.0)
"""Length, rad, over which a course around β keeps its value: some six harmonics, or two."""

LENGTHS = (0.08, 0.25)
"""Share of the order's range over which a bending course keeps its value: shorter ones look like noise over some
dozen rows, longer ones like the baseline's own terms."""


def orders(residuals: WhitenedResiduals, sensor: int) -> dict[str, Array]:
    """Orders along which a residual may run smoothly: (R,) places, relative, 0 … 1."""
    setting = residuals.baseline.setting
    keys = {"the order measured": np.arange(setting.rows, dtype=float), "the sensor's input": setting.a[:, sensor]}
    if setting.temperature is not None and len(np.unique(setting.temperature)) >= FEWEST:
        keys["temperature"] = setting.temperature
    if setting.beta is not None:
        keys["β"] = np.mod(setting.beta, 2 * np.pi)
    if setting.vibration is not None and varies(setting.vibration[:, [sensor]]):
        keys["the vibration"] = np.sqrt(setting.vibration[:, sensor])
    return {name: (key - key.min()) / np.ptp(key) for name, key in keys.items() if np.ptp(key) > 0}


def kernels(residuals: WhitenedResiduals, sensor: int) -> dict[str, list[Array]]:
    """(R, R) dimensionless covariances of courses along each order; where there is a stand, also around β together
    with another order, as whatever depends on both is smooth in both."""
    setting, places = residuals.baseline.setting, orders(residuals, sensor)
    by_name = {name: along(place) for name, place in places.items()}
    if setting.beta is None or setting.flipped is None:
        return by_name
    turning = [around(setting.beta, length) for length in ROUND]
    same_run = setting.flipped[:, None] == setting.flipped
    if not same_run.all():
        by_name["β, each run separately"] = [kernel * same_run for kernel in turning]
    for name in ("the order measured", "temperature"):
        if name in places:
            by_name[f"β and {name}"] = [bending(places[name], LENGTHS[-1]) * kernel for kernel in turning]
    return by_name


def along(place: Array) -> list[Array]:
    """(R, R) dimensionless covariances of courses along places (R,) in 0 … 1: wandering, bending, alternating."""
    bent = [bending(place, length) for length in LENGTHS]
    sign = (-1.0) ** np.argsort(np.argsort(place, kind="stable"), kind="stable")
    return [np.minimum(place[:, None], place), *bent, bent[-1] * np.outer(sign, sign)]


def bending(place: Array, length: float) -> Array:
    """(R, R) dimensionless covariance of a course along places (R,) that keeps its value over a length (Matérn 3/2)."""
    distance = np.sqrt(3) * np.abs(place[:, None] - place) / length
    return np.asarray((1 + distance) * np.exp(-distance))


def around(beta: Array, length: float) -> Array:
    """(R, R) dimensionless covariance of a course around β (R,), rad, that keeps its value over a length, rad (MacKay
    1998, periodic)."""
    return np.asarray(np.exp(-2 * (np.sin((beta[:, None] - beta) / 2) / length) ** 2))


def sensor_covariance(residuals: WhitenedResiduals, attributed: Array, sensor: int) -> Array:
    """(R, R) dimensionless covariance of one sensor's whitened residual under noise.

    ``attributed`` (n, f) orthonormal traces of the findings.
    """
    R, m = residuals.baseline.residual.shape
    rows = np.arange(R) * m + sensor
    whiten = residuals.whiten
    known = 1 - (whiten.direction[:, sensor] ** 2 * whiten.projected_out).sum(axis=-1)
    used = np.concatenate([residuals.basis[rows], attributed[rows]], axis=1)
    return np.asarray(np.diag(known) - used @ used.T)


def sensor_residual(residuals: WhitenedResiduals, attributed: Array, sensor: int) -> tuple[Array, Array]:
    """(R, n) root of one sensor's `sensor_covariance`, dimensionless, and (n,) its residual, white under noise.

    ``attributed`` (n, f) orthonormal traces of the findings. Directions that hardly show are left out.
    """
    R, m = residuals.baseline.residual.shape
    remaining = residuals.z - attributed @ (attributed.T @ residuals.z)
    size, turn = eigh(sensor_covariance(residuals, attributed, sensor))
    free = size > LEAST_FREE_NOISE
    y = (turn[:, free] / np.sqrt(size[free])).T @ remaining[: R * m].reshape(R, m)[:, sensor]
    return turn[:, free] * np.sqrt(size[free]), y


def autocorrelation(
    residuals: WhitenedResiduals, attributed: Array, sensor: int, *, known: bool
) -> Autocorrelation | None:
    """Tests whether one sensor's residual runs more smoothly than noise along some order; None where it is too short.

    ``attributed`` (n, f) orthonormal traces of the findings, dimensionless, which are projected out; ``known``: whether
    the noise is taken as stated.
    """
    root, y = sensor_residual(residuals, attributed, sensor)
    if len(y) < FEWEST:
        return None
    tried = kernels(residuals, sensor)
    each = bayes_factors(root.T @ np.concatenate(list(tried.values())) @ root, y, known=known)
    ends = np.cumsum([len(scales) for scales in tried.values()])
    factors = dict(zip(tried, map(log_mean, np.split(each, ends[:-1])), strict=True))
    prior = np.array([USUAL[name] for name in factors])
    together = np.array(list(factors.values())) + np.log(prior / prior.sum())
    return Autocorrelation(sensor, max(factors, key=lambda name: factors[name]), float(np.logaddexp.reduce(together)))


def bayes_factors(covariance: Array, y: Array, *, known: bool) -> Array:
    """(K,) ln B of courses of ``covariance`` (K, n, n), dimensionless, against white noise, from y (n,), standard
    errors."""
    scale, energy = np.maximum(np.trace(covariance, axis1=1, axis2=2), 1e-300), float(y @ y)
    diagonal, off_diagonal = tridiagonal(covariance * (len(y) / scale)[:, None, None], y)
    largest = max(SIGNAL[-1], energy if known else 0.0)
    signal = np.concatenate([SIGNAL, np.geomspace(SIGNAL[-1], largest, 4)[1:]]) if largest > SIGNAL[-1] else SIGNAL
    pivot = 1 + signal[:, None, None] * diagonal
    for k in range(len(y) - 2, -1, -1):
        pivot[..., k] -= (signal[:, None] * off_diagonal[:, k]) ** 2 / np.maximum(pivot[..., k + 1], 1.0)
    pivot = np.maximum(pivot, 1.0)
    scaled = energy / pivot[..., 0]
    fitted = 0.5 * (energy - scaled) if known else -0.5 * len(y) * np.log(scaled / energy)
    return np.asarray(np.logaddexp.reduce(fitted - 0.5 * np.log(pivot).sum(axis=-1)) - np.log(len(signal)))


def tridiagonal(matrices: Array, first: Array) -> tuple[Array, Array]:
    """(K, n) diagonals and (K, n − 1) beside them of symmetric ``matrices`` (K, n, n), dimensionless, made tridiagonal
    in orthonormal bases that begin with the direction of ``first`` (n,)."""
    mirror = first / max(float(np.linalg.norm(first)), 1e-300)
    mirror[0] += np.copysign(1.0, mirror[0])
    turn = np.eye(len(first)) - np.outer(mirror, mirror) * (2 / (mirror @ mirror))
    each = [dsytrd(matrix, lower=1) for matrix in turn @ matrices @ turn]
    return np.stack([d for _, d, *_ in each]), np.stack([e for _, _, e, *_ in each])
