"""The vectors that a stand applies: gravity, Earth rate and the applied vector of every row, with its errors.

Sources: analytic alignment paper, equations (7)–(11), (31), corrected as the errata state; Helmert (1901) gravity.
Frames and signs: see the package page.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from estimator.on_demand import function_on_demand
from estimator.session import ACCELEROMETER, Array, CalibrationSession, Site, Stand, StandErrors

if TYPE_CHECKING:
    from estimator.rotations import turn_of
else:
    turn_of = function_on_demand("estimator.rotations", "turn_of")

EARTH_RATE = 7.292115e-5
"""rad/s, against the stars; WGS 84 (NIMA TR8350.2)."""

STANDARD_GRAVITY = 9.80665
"""m/s² in one g, by definition (CGPM 1901): what data sheets and people count in, not the gravity of a site."""

FLIP = np.array([-1.0, -1.0, 1.0])
"""The block turned 180° about Z, as the signs of the applied vector that give the same products."""

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


EARTH = 9.76, 9.84
"""m/s²: gravity anywhere on the Earth's surface, from 9.764 on a mountain at the equator to 9.834 at sea level in the
Arctic (Hirt et al. 2013), rounded outwards."""
ONE_PLACE = 1e-5
"""Relative: gravity at one place, on any floor of a building of thirty metres. Tides change it by 3e-7."""
CLOCK = 1e-4
"""Relative: what an ordinary quartz clock that times counts may be wrong by without anybody's saying so; the Earth's
rate itself is the same to 1e-8."""


def common_factors(kind: str, now: Site | None, before: Site | None) -> tuple[float, float]:
    """The least and the largest relative change, dimensionless, of all scale factors of a kind of sensor together that
    the applied vector of two sessions can make.

    Gravity at one place, as stated, is the same. Where two places are stated, or one is not known, an entry may be
    wrong: then gravity by the one or by the other is any that the Earth has.
    """
    if kind != ACCELEROMETER:
        return -CLOCK, CLOCK
    if now is None or before is None:
        return EARTH[0] / EARTH[1] - 1, EARTH[1] / EARTH[0] - 1
    if now == before:
        return -ONE_PLACE, ONE_PLACE
    here, there = gravity(now), gravity(before)
    return min(EARTH[0] / here, there / EARTH[1]) - 1, max(EARTH[1] / here, there / EARTH[0]) - 1


SCHEDULES = 32
"""Schedules whose geometry is remembered, those used last: a laboratory has a few, of some 100 kB each."""


@dataclass(frozen=True, eq=False)
class Geometry:
    """Applied vectors of a schedule on every sensor. R rows, m sensors, k constant stand errors, block axes."""

    n: Array
    """(R, m, 3) applied vectors, m/s² (rad/s)."""
    norm: Array
    """(m,) length of the applied vector, m/s² (rad/s)."""
    constant: Array
    """(k, R, m, 3) change of n of each constant stand error: m/s² (rad/s) per rad, per s for the count time."""
    constant_sigma: Array
    """(k,) rad (s for the count time); errors of zero sigma are left out."""
    constant_names: tuple[str, ...]
    beta: Array
    """(R, m, 3) change of n per rad of the row's own β error, m/s² (rad/s) per rad."""
    beta_sigma: float
    """rad."""


def stand_vector(elevation: float, beta: Array, errors: StandErrors | None = None) -> Array:
    """Unit applied vector in platform axes, exact in the errors: (7)–(11).

    Parameters
    ----------
    elevation : α (or χ), rad.
    beta : (R,) rad, row errors already added.
    errors : constant errors; only theta_x, theta_y and alpha act here.

    Returns
    -------
    (R, 3) of length one, dimensionless.
    """
    e = errors or StandErrors()
    raised = elevation + e.theta_x + e.alpha
    up = np.array([e.theta_y, 0.0, 1.0]) / np.hypot(e.theta_y, 1.0)
    y, z = np.sin(raised) * up[2], np.cos(raised) * up[2]
    sin, cos = np.sin(beta), np.cos(beta)
    return np.stack([cos * up[0] - sin * z, np.full_like(beta, y), sin * up[0] + cos * z], axis=-1)


@dataclass(frozen=True)
class Schedule:
    """Facts of a session on a stand that determine its geometry, comparable and hashable by content; no readings."""

    site: Site
    stand: Stand
    count_time: float | None
    kinds: tuple[str, ...]
    """Kinds of the m sensors."""
    bits: tuple[bytes, ...]
    """Bytes of β, the runs, the mounting and the turn of the flipped run."""

    @classmethod
    def of(cls, session: CalibrationSession) -> "Schedule":
        """The schedule of a session on a stand."""
        assert session.stand is not None
        assert session.beta is not None
        arrays = (session.beta, np.asarray(session.flipped, dtype=bool), session.mounting, session.flip_turn)
        bits = tuple(np.asarray(x, dtype=bool if x.dtype == bool else float).tobytes() for x in arrays)
        kinds = tuple(s.kind for s in session.sensors)
        return cls(session.site, session.stand, session.count_time, kinds, bits)

    @property
    def beta(self) -> Array:
        """(R,) rad."""
        return np.frombuffer(self.bits[0])

    @property
    def flipped(self) -> Array:
        """(R,) bool."""
        return np.frombuffer(self.bits[1], dtype=bool)

    @property
    def mounting(self) -> Array:
        """(3, 3) dimensionless."""
        return np.frombuffer(self.bits[2]).reshape(3, 3)

    @property
    def flip_turn(self) -> Array:
        """(3,) rotation vector as (3, 3), dimensionless."""
        return np.frombuffer(self.bits[3]).copy()


def to_block(platform: Array, session: CalibrationSession | Schedule) -> Array:
    """Platform vectors (R, 3), leading axes free, as the block meets them: the same in block axes; m/s², rad/s or none.

    Rows of the flipped run are turned, then the mounting is applied: (10), (11). Where the block sits turned in the
    flipped run, its vectors turn back.
    """
    assert session.flipped is not None
    block = np.where(session.flipped[:, None], platform * FLIP, platform) @ session.mounting.T
    if not session.flip_turn.any():
        return block
    return np.where(session.flipped[:, None], block @ turn_of(session.flip_turn), block)


def elevation(stand: Stand, kind: str) -> float:
    """The stand's angle that matters for a kind of sensor: α for accelerometers, χ for gyros, rad."""
    angle = stand.alpha if kind == ACCELEROMETER else stand.chi
    assert angle is not None
    return angle


def magnitude(session: CalibrationSession | Schedule, kind: str) -> float:
    """Length of the applied vector of a kind of sensor, m/s² or rad/s."""
    return gravity(session.site) if kind == ACCELEROMETER else EARTH_RATE


def _constant_weights(session: Schedule, kind: str) -> Array:
    """(6, 3) action of each constant error: a raise of the head, a tilt across it (1 a rad), a stretch (1/s).

    Gyros by the paper's (31): the latitude raises; levelling and meridian tilt by their share of the Earth's rate.
    """
    phi = session.site.latitude or 0.0
    gyro = kind != ACCELEROMETER
    stretch = 1.0 / session.count_time if gyro and session.count_time else 0.0
    across = (np.sin(phi), np.cos(phi)) if gyro else (1.0, 0.0)
    return np.array(
        [[1, 0, 0], [0, across[0], 0], [1, 0, 0], [float(gyro), 0, 0], [0, across[1], 0], [0, 0, stretch]], dtype=float
    )


def _kind_geometry(session: Schedule, kind: str) -> Array:
    """(8, R, 3) vectors for one kind of sensor: n, dn/d(each constant error), dn/dβ; m/s² (rad/s), per rad or s."""
    beta, size, angle = session.beta, magnitude(session, kind), elevation(session.stand, kind)
    sin, cos, level = np.sin(beta), np.cos(beta), np.ones_like(beta)
    lift, reach = np.sin(angle), np.cos(angle)
    platform = np.empty((4, len(beta), 3))
    platform[0] = np.stack([-reach * sin, lift * level, reach * cos], axis=-1)
    platform[1] = np.stack([lift * sin, reach * level, -lift * cos], axis=-1)
    platform[2] = np.stack([cos, 0 * level, sin], axis=-1)
    platform[3] = -reach * platform[2]
    n, raised, tilted, turned = size * to_block(platform, session)
    constant = np.tensordot(_constant_weights(session, kind), np.stack([raised, tilted, n]), axes=1)
    return np.concatenate([n[None], constant, turned[None]])


def stand_geometry(session: CalibrationSession) -> Geometry:
    """The applied vectors of a two-axis-stand session and how the stand's errors move them; read only."""
    return _geometry(Schedule.of(session))


@lru_cache(maxsize=SCHEDULES)
def _geometry(schedule: Schedule) -> Geometry:
    """The geometry of any session with this schedule; read only."""
    kinds = schedule.kinds
    different = list(dict.fromkeys(kinds))
    by_kind = np.stack([_kind_geometry(schedule, kind) for kind in different], axis=2)
    of_sensor = by_kind[:, :, [different.index(kind) for kind in kinds]]
    sigma = schedule.stand.sigma
    sigmas = np.array([getattr(sigma, name) for name in CONSTANT_ERRORS])
    acts = (sigmas > 0) & of_sensor[1:-1].any(axis=(1, 2, 3))
    norm = np.array([magnitude(schedule, k) for k in different])[[different.index(kind) for kind in kinds]]
    constant, constant_sigma = of_sensor[1:-1][acts], sigmas[acts]
    for shared in (of_sensor, norm, constant, constant_sigma):
        shared.setflags(write=False)
    return Geometry(
        n=of_sensor[0],
        norm=norm,
        constant=constant,
        constant_sigma=constant_sigma,
        constant_names=tuple(n for n, a in zip(CONSTANT_ERRORS, acts, strict=True) if a),
        beta=of_sensor[-1],
        beta_sigma=sigma.beta,
    )
