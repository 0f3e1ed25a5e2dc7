"""Effects that readings show beside polynomials of temperature: a hysteresis loop, a lag, a misfit.

A loop adds h·leg·(1 − x²)/2 to a sensor's bias, a lag k·(L − T) with τ·dL/dt = T − L, one τ for the block, whose mass
it is, and one k a sensor. With the score u and the information F of a form's amplitudes in all sensors, given all that
is estimated, the fit gains uᵀF⁺u, of noise alone χ² of rank F; the amplitudes are F⁺u. The better form is taken first,
for the sensors whose amplitude stands out, then the other is looked for beside it.

A misfit shows in the means of what is left over bins of temperature: of the amplitudes z of one curve's bins, with
their covariance C, Q = zᵀC⁺z is χ² of rank C by noise alone, and E[Q] = rank + τ²·tr C⁺ where the curve is missed by
τ from bin to bin (moments).
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from estimator.curves import HYSTERESIS, LAG
from estimator.least_squares import inverse
from estimator.session import Array
from estimator.significance import p_value
from estimator.thermal.course import TemperatureCourse
from estimator.thermal.model import ThermalEquations, ThermalRows, linearise
from estimator.thermal.solve import ThermalFit, search_with_noise

LEVEL = 0.005
"""Probability that a sound session shows any of one kind."""
DOUBTED = 0.05
"""Probability below which a curve's misfit counts in its band, be it one to report or not."""
SEPARATED = 9.0
"""Difference of χ² below which two forms explain the same readings: three standard errors."""
BINS = 10
"""Bins over the range of temperature: twice the coefficients of the highest order."""
FLAT = 1e-6
"""Relative eigenvalue below which bins tell nothing of their own."""


@dataclass(frozen=True, eq=False)
class MisfitForm:
    """A loop, or a lag of one time constant, of all sensors that show it."""

    kind: str
    column: Array
    """(R,) dimensionless of a loop, K of a lag."""
    time_constant: float | None
    gain: float
    """Gain of the fit, relative to the noise."""
    p_value: float
    """p-value of the gain, over all forms tried."""
    sensor_p_values: Array
    """(m,) p-value of each sensor's amplitude, over all sensors."""
    alternatives: tuple[str, ...] = ()


def places(order: int) -> dict[str, int]:
    """Columns of the bias' basis that hold the forms, after polynomials of an order."""
    return {HYSTERESIS: order + 1, LAG: order + 2}


def with_column(rows: ThermalRows, place: int, column: Array) -> ThermalRows:
    """The rows with another column (R,) of the bias' basis."""
    basis = rows.bias_basis.copy()
    basis[:, place] = column
    return replace(rows, bias_basis=basis)


def noise_ratio(solved: ThermalFit, gain: float, count: int, *, stated: bool) -> float:
    """χ² per degree of freedom that ``count`` more amplitudes leave; not below one where the noise is stated."""
    left = (solved.chi2 - gain) / max(solved.dof - count, 1)
    return max(left, 1.0 if stated else 1e-6)


def amplitudes(linear: ThermalEquations, at: Array, old: Array, covariance: Array) -> tuple[Array, Array, Array]:
    """(n,) amplitudes of the elements ``at`` given those at ``old`` (k,), their covariance (n, n), and their score."""
    lean = covariance @ linear.information[np.ix_(old, at)]
    left = linear.information[np.ix_(at, at)] - linear.information[np.ix_(at, old)] @ lean
    score = linear.score[at] - lean.T @ linear.score[old]
    information = np.diagonal(linear.information)[at]
    left[np.diagonal(left) <= FLAT * information] = 0.0
    left[:, ~left.any(axis=1)] = 0.0
    known = inverse(left, FLAT)
    return known @ score, known, score


def tried_forms(
    solved: ThermalFit, course: TemperatureCourse, order: int, kinds: set[str], *, stated: bool
) -> Iterator[MisfitForm]:
    """Every form of some kinds, with what it explains."""
    columns: list[tuple[str, Array, float | None]] = []
    if HYSTERESIS in kinds and {1.0, -1.0} <= set(course.leg.tolist()):
        columns.append((HYSTERESIS, course.loop, None))
    if LAG in kinds:
        columns += [(LAG, course.behind(float(tau)), float(tau)) for tau in course.time_constants]
    m, p = solved.free.shape
    old = np.arange(m * p)
    for kind, column, tau in columns:
        linear = linearise(with_column(solved.rows, places(order)[kind], column), solved.state)
        at = np.arange(m) * p + solved.state.scale.shape[1] + places(order)[kind]
        size, known, score = amplitudes(linear, at, old, solved.covariance)
        variance = np.diagonal(known)
        gain, rank = float(score @ size), int((variance > 0).sum())
        ratio = noise_ratio(solved, gain, rank, stated=stated)
        statistic = np.where(variance > 0, size**2 / np.where(variance > 0, variance, 1.0), 0.0) / ratio
        chance = float(p_value(gain / ratio, rank, solved.dof - rank)) * len(columns)
        p_values = np.minimum(1.0, p_value(statistic, 1, solved.dof - rank) * m)
        yield MisfitForm(kind, column, tau, gain / ratio, min(1.0, chance), p_values)


def with_forms(
    solved: ThermalFit, course: TemperatureCourse, order: int, *, stated: bool
) -> tuple[ThermalFit, tuple[MisfitForm, ...]]:
    """The fit with the forms that its readings show."""
    found: list[MisfitForm] = []
    for _ in range(len(places(order))):
        kinds = set(places(order)) - {form.kind for form in found}
        forms = list(tried_forms(solved, course, order, kinds, stated=stated))
        price = {HYSTERESIS: 0.0, LAG: float(np.log(len(course.temperature)))}
        best = max(forms, key=lambda form: form.gain - price[form.kind], default=None)
        if best is None or best.p_value >= LEVEL or not (best.sensor_p_values < LEVEL).any():
            break
        others = [form.kind for form in forms if form.kind != best.kind and form.gain > best.gain - SEPARATED]
        found.append(replace(best, alternatives=tuple(dict.fromkeys(others))))
        free = solved.free.copy()
        free[best.sensor_p_values < LEVEL, solved.state.scale.shape[1] + places(order)[best.kind]] = True
        rows = with_column(solved.rows, places(order)[best.kind], best.column)
        solved = search_with_noise(rows, solved.state, free, stated=stated)
    return solved, tuple(found)


@dataclass(frozen=True, eq=False)
class Misfits:
    """Misfit of the curves of m sensors: for scale factor and bias."""

    sigma: Array
    """(m, 2) dimensionless (of a gyro's bias rad/s); zero where noise explains it."""
    p_value: Array
    """(m, 2) p-values over all curves."""


def misfits(solved: ThermalFit, course: TemperatureCourse, *, stated: bool) -> Misfits:
    """Misfits of the curves, from the residuals over bins of temperature."""
    linear, at, old = binned(solved, course)
    size, known, score = amplitudes(linear, at.ravel(), old, solved.covariance)
    count = int((np.diagonal(known) > 0).sum())
    ratio = noise_ratio(solved, float(score @ size), count, stated=stated)
    m, found = len(at), []
    for k in range(2 * m):
        part = slice(k * BINS, (k + 1) * BINS)
        found.append(misfit(size[part], known[part, part] * ratio, solved.dof - count))
    sigma, chance = np.array(found).reshape(m, 2, 2).transpose(2, 0, 1)
    return Misfits(sigma, np.minimum(1.0, chance * 2 * m))


def misfit(size: Array, covariance: Array, freedom: int) -> tuple[float, float]:
    """τ and the p-value of the amplitudes (BINS,) of one curve's bins, with their covariance; freedom of the noise."""
    value, vector = np.linalg.eigh(covariance)
    seen = value > FLAT * max(float(value[-1]), np.finfo(float).tiny)
    rank, Q = int(seen.sum()), float(((vector.T @ size)[seen] ** 2 / value[seen]).sum())
    chance = float(p_value(Q, rank, max(freedom, 1)))
    if chance >= DOUBTED:
        return 0.0, chance
    return float(np.sqrt(max(0.0, Q - rank) / (1 / value[seen]).sum())), chance


def binned(solved: ThermalFit, course: TemperatureCourse) -> tuple[ThermalEquations, Array, Array]:
    """The fit with bins of temperature beside its curves: where these stand, (m, 2, BINS), and where its own, (P,)."""
    (m, p), q, b = solved.free.shape, solved.state.scale.shape[1], solved.state.bias.shape[1]
    columns = np.eye(BINS)[np.minimum(((course.x(course.temperature) + 1) / 2 * BINS).astype(int), BINS - 1)]
    rows = replace(
        solved.rows,
        scale_basis=np.hstack([solved.rows.scale_basis, columns]),
        bias_basis=np.hstack([solved.rows.bias_basis, columns]),
    )
    scale, bias = (np.pad(part, ((0, 0), (0, BINS))) for part in (solved.state.scale, solved.state.bias))
    linear = linearise(rows, replace(solved.state, scale=scale, bias=bias))
    wide, bins = rows.elements * np.arange(m)[:, None], np.arange(BINS)
    at = np.stack([wide + q + bins, wide + q + BINS + b + bins], axis=1)
    kept = np.r_[0:q, q + BINS : q + BINS + b, p + 2 * BINS - 3 : p + 2 * BINS]
    return linear, at, (wide + kept).ravel()
