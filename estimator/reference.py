"""What the stand applies: gravity, Earth rate and the reference vector of every row, with its errors.

Sources: analytic alignment paper, equations (7)–(11), (31), corrected as the errata state; Helmert (1901) gravity.
Frames and signs: see the package page.
"""

from dataclasses import dataclass

import numpy as np

from estimator.session import ACCELEROMETER, Array, CalibrationSession, Site, Stand, StandErrors

EARTH_RATE = 7.292115e-5
"""rad/s."""

FLIP = np.diag([-1.0, -1.0, 1.0])
"""The block turned 180° about Z, as the turn of the reference vector that gives the same products."""

CONSTANT_ERRORS = ("theta_x", "theta_y", "alpha", "latitude", "meridian", "count_time")
"""Stand errors that last a whole session, in the order of `Geometry.constant`."""


def gravity(site: Site) -> float:
    """Gravity at a site, m/s²: the measured value where stated, else Helmert's formula with the free-air term.

    The paper's (9) as printed lacks the bracket that makes its coefficients factors of 9.78030.
    """
    if site.gravity is not None:
        return site.gravity
    phi = site.latitude or 0.0
    normal = 9.78030 * (1 + 0.005302 * np.sin(phi) ** 2 - 0.000007 * np.sin(2 * phi) ** 2)
    return float(normal - 2 * 1.543e-6 * site.height)


@dataclass(frozen=True, eq=False)
class Geometry:
    """What a schedule applies to every sensor. R rows, m sensors, k constant stand errors, block axes."""

    n: Array
    """(R, m, 3) reference vectors, m/s² (rad/s)."""
    norm: Array
    """(m,) length of the reference vector."""
    constant: Array
    """(k, R, m, 3) change of n per unit of each constant stand error."""
    constant_sigma: Array
    """(k,) rad (s for the count time); errors of zero sigma are left out."""
    constant_names: tuple[str, ...]
    beta: Array
    """(R, m, 3) change of n per rad of the row's own β error."""
    beta_sigma: float
    """rad."""


def stand_vector(elevation: float, beta: Array, errors: StandErrors | None = None) -> Array:
    """Unit reference vector in platform axes, exact in the errors.

    Parameters
    ----------
    elevation : α (or χ), rad.
    beta : (R,) rad, row errors already added.
    errors : constant errors; only theta_x, theta_y and alpha act here.

    Returns
    -------
    (R, 3) of length one.
    """
    e = errors or StandErrors()
    raised = elevation + e.theta_x + e.alpha
    up = np.array([e.theta_y, 0.0, 1.0]) / np.hypot(e.theta_y, 1.0)
    y, z = np.sin(raised) * up[2], np.cos(raised) * up[2]
    sin, cos = np.sin(beta), np.cos(beta)
    return np.stack([cos * up[0] - sin * z, np.full_like(beta, y), sin * up[0] + cos * z], axis=-1)


def to_block(platform: Array, session: CalibrationSession) -> Array:
    """(R, 3) platform vectors as the block meets them: flipped runs turned, then the mounting applied."""
    assert session.flipped is not None
    met = np.where(session.flipped[:, None], platform @ FLIP, platform)
    return met @ session.mounting.T


def elevation(stand: Stand, kind: str) -> float:
    """The stand's angle that matters for a kind of sensor: α for accelerometers, χ for gyros, rad."""
    angle = stand.alpha if kind == ACCELEROMETER else stand.chi
    assert angle is not None
    return angle


def magnitude(session: CalibrationSession, kind: str) -> float:
    """Length of the reference vector of a kind of sensor, m/s² or rad/s."""
    return gravity(session.site) if kind == ACCELEROMETER else EARTH_RATE


def _kind_geometry(session: CalibrationSession, kind: str) -> tuple[Array, Array, Array]:
    """n (R, 3), dn/d(constant errors) (6, R, 3) and dn/dβ (R, 3) for one kind of sensor."""
    stand, beta = session.stand, session.beta
    assert stand is not None
    assert beta is not None
    size, angle = magnitude(session, kind), elevation(stand, kind)
    sin, cos = np.sin(beta), np.cos(beta)
    n = size * stand_vector(angle, beta)
    d_raise = size * np.stack([np.sin(angle) * sin, np.full_like(beta, np.cos(angle)), -np.sin(angle) * cos], -1)
    d_beta = size * np.cos(angle) * np.stack([-cos, np.zeros_like(beta), -sin], -1)
    d_level = -d_beta / np.cos(angle)
    none = np.zeros_like(n)
    if kind == ACCELEROMETER:
        constant = [d_raise, d_level, d_raise, none, none, none]
    else:
        phi = session.site.latitude or 0.0
        d_time = n / session.count_time if session.count_time else none
        constant = [d_raise, d_level * np.sin(phi), d_raise, d_raise, d_level * np.cos(phi), d_time]
    turned = [to_block(v, session) for v in (n, *constant, d_beta)]
    return turned[0], np.stack(turned[1:-1]), turned[-1]


def stand_geometry(session: CalibrationSession) -> Geometry:
    """The reference vectors of a two-axis-stand session and how the stand's errors move them."""
    assert session.stand is not None
    kinds = [s.kind for s in session.sensors]
    found = {kind: _kind_geometry(session, kind) for kind in dict.fromkeys(kinds)}
    sigma = session.stand.sigma
    sigmas = np.array([getattr(sigma, name) for name in CONSTANT_ERRORS])
    constant = np.stack([found[k][1] for k in kinds], axis=2)
    acts = (sigmas > 0) & (np.abs(constant).max(axis=(1, 2, 3)) > 0)
    return Geometry(
        n=np.stack([found[k][0] for k in kinds], axis=1),
        norm=np.array([magnitude(session, k) for k in kinds]),
        constant=constant[acts],
        constant_sigma=sigmas[acts],
        constant_names=tuple(n for n, a in zip(CONSTANT_ERRORS, acts, strict=True) if a),
        beta=np.stack([found[k][2] for k in kinds], axis=1),
        beta_sigma=sigma.beta,
    )
