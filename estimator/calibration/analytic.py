"""The closed form of the analytic alignment paper, with the rank defect of its matrix (26) resolved.

Half sums and half differences of the direct and flipped readings at one β are linear in known functions of β:

    U1 = p0 + q12·n1 + q13·n3 + p4·(n1² − n3²)          (18), one second-order column instead of two
    U2 = q21 + q22·n1 + q23·n3 + q24·n1·n3              (20)

n1² + n3² = C² = g²cos²α at every position, so the paper's columns 1, 4, 5 are dependent and its C₁ is singular.
Here both are one regression, u = U1 ± U2 with the sign of the run, which on paired runs is the same estimate and needs
no pairs: unequal steps, missing and repeated positions enter as they are. Then K, e by (22), (23), and c from all four
second-order coefficients by weighted least squares, where the paper's (25) divides by e1².

Platform axes, and n in units of g·cos α (n1, n3) or g (n2), so that gyros condition as well as accelerometers.
S sessions, R rows, m sensors.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from estimator.applied_vector import SCHEDULES, elevation
from estimator.arrays import unit
from estimator.parameters import SensorParameters
from estimator.session import Array, CalibrationSession

VANISHES = 1e-6
"""Root mean square, of functions of size 1, below which a column has no trace in the schedule (n1·n3 on four faces):
beyond the rounding of stated angles, below any turn of a head."""

DEPENDENT = 1e-8
"""Relative singular value below which the schedule does not determine all columns: half the digits of a double are
lost there."""

CONSTANT = 1e-6
"""Part of a reading that must change over the rows for the sensor to answer to anything: gravity and the Earth's rate
change one that is alive by far more, even on a large offset."""

NO_TRACE = 1e-12
"""Squared trace of the second-order term in the coefficients, relative, below which there is none: 1e-6, squared."""

SECOND_ORDER = [1, 3, 6, 7]
"""Places of q12, p4, q23, q24 among the eight coefficients."""


@dataclass(frozen=True, eq=False)
class Coefficients:
    """The linear coefficients p0, q12, q13, p4, q21, q22, q23, q24 of (18) and (20)."""

    value: Array
    """(..., 8, m) reading units."""
    variance: Array
    """(8,) per unit variance of a reading; infinite where the schedule leaves no trace of a coefficient."""


def design(beta: Array, flipped: Array) -> Array:
    """(R, 8) functions of β, dimensionless, that (18) and (20) are linear in; a flipped run has U2 of the other sign.

    beta : (R,) rad; flipped : (R,) bool.
    """
    ones, x, z = np.ones_like(beta), -np.sin(beta), np.cos(beta)
    run = np.where(flipped, -1.0, 1.0)
    return np.stack([ones, x, z, x * x - z * z, run, run * x, run * z, run * x * z], axis=-1)


def coefficients(y: Array, beta: Array, flipped: Array) -> Coefficients | None:
    """Least squares for (18) and (20) together; None where the rows do not determine them.

    y : (..., R, m) readings, reading units; beta : (R,) rad; flipped : (R,) bool.
    """
    solution = pseudo_inverse(np.asarray(beta, dtype=float).tobytes(), np.asarray(flipped, dtype=bool).tobytes())
    return None if solution is None else Coefficients(solution[0] @ y, solution[1])


@lru_cache(maxsize=SCHEDULES)
def pseudo_inverse(beta: bytes, flipped: bytes) -> tuple[Array, Array] | None:
    """(8, R) pseudo-inverse of the `design` and (8,) variance of each coefficient per unit variance of a reading, both
    dimensionless and read only; None where the rows do not determine the coefficients.

    ``beta``, ``flipped``: the content of `design`'s arrays.
    """
    columns = design(np.frombuffer(beta), np.frombuffer(flipped, dtype=bool))
    live = np.sqrt((columns**2).mean(axis=0)) > VANISHES
    if len(columns) < live.sum():
        return None
    left, size, right = np.linalg.svd(columns[:, live], full_matrices=False)
    if size[-1] < DEPENDENT * size[0]:
        return None
    inverse = np.zeros((8, len(columns)))
    inverse[live] = (right.T / size) @ left.T
    variance = np.where(live, (inverse**2).sum(axis=1), np.inf)
    for shared in (inverse, variance):
        shared.setflags(write=False)
    return inverse, variance


def solve(q: Coefficients, size: Array, angle: Array) -> SensorParameters:
    """K, b, c and e in platform axes by (22)–(25) in their corrected form.

    Parameters
    ----------
    q : (..., 8, m) reading units.
    size : (m,) g in m/s², or the Earth rate in rad/s.
    angle : (m,) α, or χ, rad.

    Returns
    -------
    (..., m) in platform axes; where the second-order term leaves no trace (e = (0, ±1, 0)) c is zero, where a reading
    is constant K is.
    """
    lift, reach = np.sin(angle), np.cos(angle)
    p0, q12, q13, p4, q21, q22, q23, q24 = (q.value[..., k, :] for k in range(8))
    s1, s2, s3 = q22 / reach, q21 / lift, q13 / reach
    gain = np.sqrt(s1**2 + s2**2 + s3**2)
    some = np.where(gain > 0, gain, 1.0)
    e1, e2, e3 = s1 / some, s2 / some, s3 / some
    per_c = reach * np.array([2 * e1 * e2 * lift, reach * (e1**2 - e3**2) / 2, 2 * e2 * e3 * lift, 2 * reach * e1 * e3])
    weight = 1.0 / q.variance[SECOND_ORDER]
    weighted = np.einsum("k,k...->k...", weight, per_c)
    trace = (weighted * per_c).sum(axis=0)
    blind = trace < NO_TRACE * weight.max()
    seen = (weighted * np.array([q12, p4, q23, q24])).sum(axis=0) / some
    c = np.where(blind, 0.0, seen / np.where(blind, 1.0, trace))
    b = p0 / some - c * (e2**2 * lift**2 + (e1**2 + e3**2) * reach**2 / 2)
    return SensorParameters(gain / size, b * size, c / size, np.stack([e1, e2, e3], axis=-1))


def answers(y: Array) -> Array:
    """Whether the readings (R, m) of each sensor change at all: (m,) bool; leading axes free, any unit."""
    return np.ptp(y, axis=-2) > CONSTANT * np.abs(y).max(axis=-2)


def closed_form(
    y: Array, session: CalibrationSession, nominal: SensorParameters, size: Array
) -> SensorParameters | None:
    """The paper's estimate, or None where the rows do not determine it (one run, too few positions).

    Parameters
    ----------
    y : (..., R, m) readings with the offset taken off, reading units.
    session : gives the schedule, stand and mounting.
    nominal : (m,) what a sensor with a constant reading is put at.
    size : (m,) length of the applied vectors, m/s² (rad/s).

    Returns
    -------
    Parameters (..., m) with the axes in block axes. What leaves no trace is reported by the refinement.
    """
    assert session.beta is not None
    assert session.flipped is not None
    assert session.stand is not None
    q = coefficients(y, session.beta, session.flipped)
    if q is None:
        return None
    of_kind = {kind: elevation(session.stand, kind) for kind in {s.kind for s in session.sensors}}
    p = solve(q, size, np.array([of_kind[s.kind] for s in session.sensors]))
    alive = answers(y)
    return SensorParameters(
        np.where(alive, p.scale, nominal.scale),
        np.where(alive, p.bias, 0.0),
        np.where(alive, p.quadratic, 0.0),
        np.where(alive[..., None], p.axis @ session.mounting.T, nominal.axis),
    )


TO_BIAS = 1e3
"""Weight of the bias' column, by which what the rows cannot tell from a bias is attributed to it rather than to scale
and axis: a bias may be many g (counts without a stated offset), scale and axis stay within per cent of nominal."""


def linear_start(y: Array, n: Array, size: Array, nominal: SensorParameters) -> SensorParameters:
    """Start where there is no closed form: u = K·b + K·e·n by least squares about the nominal values.

    Parameters
    ----------
    y : (..., R, m) readings with the offset taken off, reading units.
    n : (R, m, 3) applied vectors of lengths ``size`` (m,), m/s² (rad/s).

    Returns
    -------
    (..., m), c = 0; what the rows do not determine stays at its nominal value.
    """
    direction = np.swapaxes(n, 0, 1) / size[:, None, None]
    sensitivity = (nominal.scale * size)[:, None] * nominal.axis
    expected = (direction @ sensitivity[..., None])[..., 0].T
    columns = np.concatenate([np.full((*direction.shape[:2], 1), TO_BIAS), direction], axis=-1)
    change = np.einsum("mfr,...rm->...mf", np.linalg.pinv(columns, rcond=DEPENDENT / TO_BIAS), y - expected)
    sensitivities = sensitivity + change[..., 1:]
    gain = np.linalg.norm(sensitivities, axis=-1)
    return SensorParameters(
        gain / size, TO_BIAS * change[..., 0] * size / gain, np.zeros_like(gain), unit(sensitivities)
    )
