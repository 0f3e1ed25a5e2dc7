"""The closed form of the analytic alignment paper, with the rank defect of its matrix (26) resolved.

Half sums and half differences of the direct and flipped readings at the same β are linear in known functions of β:

    U1 = p0 + q12·n1 + q13·n3 + p4·(n1² − n3²)          (18), one second-order column instead of two
    U2 = q21 + q22·n1 + q23·n3 + q24·n1·n3              (20)

n1² + n3² = C² = g²cos²α at every position, so the paper's columns 1, 4, 5 are dependent and its C₁ is singular.
Then K, e by (22), (23), and c from all four second-order coefficients by weighted least squares, where the paper's
(25) divides by e1². Platform axes inside; S sessions, N positions of each run, m sensors.
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import unit
from estimator.parameters import SensorParameters
from estimator.reference import elevation, magnitude, stand_vector
from estimator.session import ACCELEROMETER, Array, CalibrationSession

SAME_ANGLE = 1e-9
"""rad; two settings of β closer than this are one position."""


@dataclass(frozen=True, eq=False)
class Pairing:
    """Which rows of the direct and the flipped run belong to one β. N positions, R rows."""

    beta: Array
    """(N,) rad."""
    direct: Array
    """(N, R) averages the direct rows of each position."""
    flipped: Array
    """(N, R)"""


def pair_runs(session: CalibrationSession) -> Pairing | None:
    """Match the two runs by β (modulo a turn); None unless both runs visit at least four common positions."""
    assert session.beta is not None
    assert session.flipped is not None
    key = np.round(np.mod(session.beta + SAME_ANGLE / 2, 2 * np.pi) / SAME_ANGLE).astype(np.int64)
    common = np.intersect1d(key[session.flipped], key[~session.flipped])
    if len(common) < 4:
        return None
    belongs = common[:, None] == key
    direct, flipped = belongs & ~session.flipped, belongs & session.flipped
    return Pairing(
        beta=common * SAME_ANGLE,
        direct=direct / direct.sum(axis=1, keepdims=True),
        flipped=flipped / flipped.sum(axis=1, keepdims=True),
    )


@dataclass(frozen=True, eq=False)
class Coefficients:
    """The eight linear coefficients, each (..., m), and the variance factors of the four second-order ones."""

    p0: Array
    q12: Array
    q13: Array
    p4: Array
    q21: Array
    q22: Array
    q23: Array
    q24: Array
    variance: Array
    """(4,) of q12, p4, q23, q24, per unit variance of U1, U2."""


def coefficients(u1: Array, u2: Array, n1: Array, n3: Array) -> Coefficients:
    """Least squares for (18) and (20): u1, u2 (..., N, m); n1, n3 (N,)."""
    one = np.ones_like(n1)
    b1 = np.stack([one, n1, n3, n1 * n1 - n3 * n3], axis=-1)
    b2 = np.stack([one, n1, n3, n1 * n3], axis=-1)
    inverse1, inverse2 = np.linalg.pinv(b1), np.linalg.pinv(b2)
    q1, q2 = inverse1 @ u1, inverse2 @ u2
    v1, v2 = (inverse1**2).sum(axis=1), (inverse2**2).sum(axis=1)
    return Coefficients(
        *(q[..., i, :] for q in (q1, q2) for i in range(4)),
        np.array([v1[1], v1[3], v2[2], v2[3]]),
    )


def solve(q: Coefficients, size: float, angle: float) -> SensorParameters:
    """K, b, c and e in platform axes from the coefficients; ``size`` is g (Ω), ``angle`` α (χ)."""
    n2, C2 = size * np.sin(angle), (size * np.cos(angle)) ** 2
    sensitivity = np.stack([q.q22, q.q21 / n2, q.q13], axis=-1)
    K, e = np.linalg.norm(sensitivity, axis=-1), unit(sensitivity)
    e1, e2, e3 = e[..., 0], e[..., 1], e[..., 2]
    seen = np.stack([q.q12, q.p4, q.q23, q.q24])
    per_c = K * np.stack([2 * e1 * e2 * n2, (e1**2 - e3**2) / 2, 2 * e2 * e3 * n2, 2 * e1 * e3])
    weight = 1.0 / q.variance.reshape(4, *[1] * K.ndim)
    known = (weight * per_c**2).sum(axis=0)
    blind = known * size**2 < 1e-12 * (K**2 * weight.max())
    c = np.where(blind, 0.0, (weight * per_c * seen).sum(axis=0) / np.where(blind, 1.0, known))
    b = q.p0 / K - c * (e2**2 * n2**2 + (e1**2 + e3**2) * C2 / 2)
    return SensorParameters(K, b, c, e)


def closed_form(y: Array, session: CalibrationSession) -> SensorParameters | None:
    """The paper's estimate, or None where the runs do not pair.

    Parameters
    ----------
    y : (..., R, m) readings with the offset taken off.
    session : gives the schedule, stand and mounting.

    Returns
    -------
    Parameters (..., m) with the axes in block axes. Where the second-order term leaves no trace (e = (0, ±1, 0)),
    c is put at zero; the refinement reports it as not observable.
    """
    pairing = pair_runs(session)
    if pairing is None:
        return None
    assert session.stand is not None
    u, flipped = pairing.direct @ y, pairing.flipped @ y
    parts = []
    for kind in dict.fromkeys(s.kind for s in session.sensors):
        size, angle = magnitude(session, kind), elevation(session.stand, kind)
        n = size * stand_vector(angle, pairing.beta)
        q = coefficients((u + flipped) / 2, (u - flipped) / 2, n[:, 0], n[:, 2])
        parts.append((kind, solve(q, size, angle)))
    platform = merge(parts, session)
    return SensorParameters(platform.scale, platform.bias, platform.quadratic, platform.axis @ session.mounting.T)


def merge(parts: list[tuple[str, SensorParameters]], session: CalibrationSession) -> SensorParameters:
    """Each sensor's parameters from the solution made with its own kind's reference vector."""
    if len(parts) == 1:
        return parts[0][1]
    (_, a), (_, g) = parts if parts[0][0] == ACCELEROMETER else parts[::-1]
    accelerometer = np.array([s.kind == ACCELEROMETER for s in session.sensors])
    return SensorParameters(
        np.where(accelerometer, a.scale, g.scale),
        np.where(accelerometer, a.bias, g.bias),
        np.where(accelerometer, a.quadratic, g.quadratic),
        np.where(accelerometer[:, None], a.axis, g.axis),
    )


def linear_start(y: Array, n: Array, nominal: SensorParameters) -> SensorParameters:
    """Start where the runs do not pair: u = K·b + K·e·n by least squares about the nominal values.

    y (..., R, m), n (R, m, 3); what the rows do not determine stays at its nominal value.
    """
    m = y.shape[-1]
    size = np.linalg.norm(n[0, :, :], axis=-1)
    sensitivity = nominal.scale[:, None] * nominal.axis
    expected = nominal.scale * nominal.bias + (n * sensitivity).sum(axis=-1)
    found = []
    for i in range(m):
        design = np.concatenate([np.full((len(n), 1), size[i]), n[:, i, :]], axis=1)
        found.append((y[..., i] - expected[:, i]) @ np.linalg.pinv(design, rcond=1e-6).T)
    delta = np.stack(found, axis=-2)
    s = sensitivity + delta[..., 1:]
    K = np.linalg.norm(s, axis=-1)
    return SensorParameters(K, nominal.bias + delta[..., 0] * size / K, np.zeros_like(K), unit(s))
