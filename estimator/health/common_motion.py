"""What all sensors of a block do together since the reference, apart from what each of them does alone.

A block that sits otherwise in its fixture, a fixture or a stand that has turned, a wrong gravity: all of them move
every sensor at once and say nothing of any sensor. The changes y of all axes (scales) since the reference session are

    y = A·x + s + ε,    cov ε = C, the total covariance of both sessions, sensors correlated

axes     y (2 m) along the tangents p, o of the reference axes, x the rotation vector θ common to the block (3):
         e moves by θ × e, so the row of a tangent t is (e × t)ᵀ.
scales   y (m) relative changes, x the common factor (1): A is a column of ones.
s        what single sensors did: zero but for those that are left out.

x is the generalised least squares estimate from the sensors that agree; what is left of a sensor is y − A·x, with the
covariance M·C·Mᵀ, M = I − A·(AᵀVA)⁻¹AᵀV, V the inverse of C over the sensors that agree and zero elsewhere. A sensor
that is left out has no part in x: its drift does not smear into the others, nor the common part into it.

Sensors of a healthy block wander a little, each on its own, often by more than a good stand's uncertainty. Who moved is
asked with C + τ²·1, τ the smallest part of the tolerance, up to a fifth, with which a majority agrees: a drift is left
out while it is small. x is then taken with τ a tenth of the tolerance at least, and is as uncertain as that makes it;
what is left was measured with C.

Left out is, one after another, the sensor whose own change raises the likelihood most, while twice the gain of the log
likelihood, (Eᵀ·W·y)ᵀ(EᵀWE)⁻¹(EᵀWy) with W = V − VA(AᵀVA)⁻¹AᵀV (chi-square with as many degrees of freedom as the
sensor has rows), is beyond the level α = 0.1 % over all m sensors (Šidák). A sensor that would do instead of one of
them nearly as well (χ² higher by less than 2·ln 100) may be the one that moved and is left out too. The sensors that
remain must be more than half of all; if they are not, nobody can tell who moved: nothing is taken off and every sensor
is judged on its whole change. Axes of fewer than four sensors, and scales of fewer than three, never tell: of two axes
that have parted, either may have moved.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from estimator.health.deviation import Deviation, deviation
from estimator.results import NOMINAL_AXES, Calibration, SensorCalibration
from estimator.session import Array

AXES, SCALES = "axes", "scales"
SEPARATED, TOO_FEW, UNCLEAR = "separated", "too-few-sensors", "unclear"
LEVEL = 0.001
RIVAL = 2 * np.log(100)
"""A rival explanation whose χ² is higher by less than this (likelihood a hundredth) is not ruled out."""
SCATTERS = (0.0, 0.025, 0.05, 0.1, 0.2)
"""τ as parts of the tolerance, in the order tried."""
NOTHING = 0.1
"""What a sensor may do on its own without anybody's concern, part of the tolerance."""
FEWEST = {AXES: 4, SCALES: 3}
"""Sensors that it takes to tell a common change from a single one."""
PARALLEL = 1e-3
"""Smallest eigenvalue of AᵀA per sensor below which the axes do not span space."""


@dataclass(frozen=True)
class CommonMotion:
    """What the axes, or the scales, of all sensors of one kind did together since the reference."""

    kind: str
    """``accelerometer`` or ``gyroscope``."""
    quantity: str
    """``axes`` or ``scales``."""
    state: str
    """``separated``; otherwise nothing was taken off: ``too-few-sensors``, or ``unclear`` which of them moved."""
    value: tuple[float, ...]
    """Rotation vector in block axes, rad (3), or relative change of all scales (1); empty unless separated."""
    covariance: tuple[tuple[float, ...], ...]
    """Of the value, total, of both sessions."""
    p_value: float | None
    """Chance of a common change at least this large when nothing moved together; None where the block's frame is held
    by the axes themselves, so that a common turn cannot be seen."""
    sensors: tuple[str, ...]
    """That the common change rests on."""
    left_out: tuple[str, ...]
    """That moved on their own, or cannot be told from one that did; the most evident first."""

    @property
    def size(self) -> float:
        """Angle of the rotation, rad, or the relative change with its sign."""
        return size_of(self.quantity, self.value)

    @property
    def sigma(self) -> float:
        """One sigma of the size."""
        return sigma_of(self.value, self.covariance)


def size_of(quantity: str, value: Sequence[float]) -> float:
    """Angle of a rotation vector (3,), rad, or the relative change of all scales (1,) with its sign."""
    return float(np.linalg.norm(value)) if quantity == AXES else float(value[0])


def sigma_of(value: Sequence[float], covariance: Sequence[Sequence[float]]) -> float:
    """One sigma of the size of a common change (k,): along its direction, from its covariance (k, k)."""
    vector, length = np.array(value), float(np.linalg.norm(value))
    along = vector / length if length > 0 else np.eye(len(vector))[0]
    return float(np.sqrt(along @ np.array(covariance) @ along))


@dataclass(frozen=True, eq=False)
class Split:
    """The common part, and what is left of each sensor."""

    motion: CommonMotion
    left: dict[str, Deviation]
    """By sensor; empty unless the common part was separated."""


@dataclass(frozen=True, eq=False)
class _Changes:
    """The changes of one quantity of m sensors, stacked; r rows a sensor."""

    names: tuple[str, ...]
    y: Array
    """(m r,)"""
    own: Array
    """(m r, m r)"""
    origin: Array
    """(m r, m r)"""
    design: Array
    """(m r, k)"""
    scatter: float = 0.0
    """τ, unit of y."""

    @property
    def rows(self) -> int:
        return len(self.y) // max(len(self.names), 1)

    @property
    def covariance(self) -> Array:
        """(m r, m r) of both sessions, and what sensors do on their own."""
        return self.own + self.origin + self.scatter**2 * np.eye(len(self.y))

    def where(self, sensors: list[int]) -> Array:
        """The rows of some sensors."""
        return (np.array(sensors, dtype=int)[:, None] * self.rows + np.arange(self.rows)).ravel()


@dataclass(frozen=True, eq=False)
class _Fit:
    """Generalised least squares over some sensors."""

    gain: Array
    """(k, m r) x = gain · y."""
    weight: Array
    """(m r, m r) W."""
    chi2: float


def common_motion(
    current: Calibration, reference: Calibration, tolerances: Mapping[tuple[str, str], float] | None = None
) -> tuple[Split, ...]:
    """The splits of every kind of sensor that both sessions hold: axes, then scales; SI, block axes.

    ``tolerances`` by (kind, ``axis`` or ``scale``) say what counts as nothing; without one only noise does.
    """
    allowed = tolerances or {}
    kinds = dict.fromkeys(sensor.kind for sensor in current.sensors)
    framed = NOMINAL_AXES not in (current.gauge, reference.gauge)
    found = []
    for kind in kinds:
        pairs = _pairs(current, reference, kind)
        axes, scales = _axes(pairs, current, reference), _scales(pairs, current, reference)
        found.append(_split(kind, AXES, axes, allowed.get((kind, "axis"), 0.0), seen=framed))
        found.append(_split(kind, SCALES, scales, allowed.get((kind, "scale"), 0.0), seen=True))
    return tuple(split for split in found if split is not None)


Pairs = list[tuple[SensorCalibration, SensorCalibration]]


def _pairs(current: Calibration, reference: Calibration, kind: str) -> Pairs:
    then = {sensor.name: sensor for sensor in reference.sensors if sensor.kind == kind}
    return [(now, then[now.name]) for now in current.sensors if now.kind == kind and now.name in then]


def _joint(calibration: Calibration, names: list[str]) -> Array | None:
    """The total covariance of some elements; None where the calibration does not hold all of them."""
    place = {name: i for i, name in enumerate(calibration.names)}
    if not names or not all(name in place for name in names):
        return None
    rows = [place[name] for name in names]
    found = calibration.covariance[np.ix_(rows, rows)]
    return found if np.isfinite(found).all() else None


def _axes(pairs: Pairs, current: Calibration, reference: Calibration) -> _Changes | None:
    known = [(now, then, d) for now, then in pairs if (d := deviation(now, then, "axis")) and _finite(d)]
    elements = [f"{now.name}.{element}" for now, _, _ in known for element in ("axis_1", "axis_2")]
    own, origin = _joint(current, elements), _joint(reference, elements)
    if own is None or origin is None:
        return None
    turn = np.zeros((2 * len(known), 2 * len(known)))
    for i, (now, then, _) in enumerate(known):
        turn[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = then.axis_tangents.T @ now.axis_tangents
    design = np.concatenate([np.cross(np.asarray(then.axis), then.axis_tangents.T) for _, then, _ in known])
    y = np.concatenate([d.vector for _, _, d in known])
    return _Changes(tuple(now.name for now, _, _ in known), y, turn @ own @ turn.T, origin, design)


def _scales(pairs: Pairs, current: Calibration, reference: Calibration) -> _Changes | None:
    known = [(now, then, d) for now, then in pairs if (d := deviation(now, then, "scale")) and _finite(d)]
    elements = [f"{now.name}.scale" for now, _, _ in known]
    own, origin = _joint(current, elements), _joint(reference, elements)
    if own is None or origin is None:
        return None
    y = np.array([d.vector[0] for _, _, d in known])
    then = np.array([t.scale.value for _, t, _ in known], dtype=float)
    ratio = (1 + y) / then
    names = tuple(now.name for now, _, _ in known)
    return _Changes(names, y, own / np.outer(then, then), origin * np.outer(ratio, ratio), np.ones((len(y), 1)))


def _finite(found: Deviation) -> bool:
    return bool(np.isfinite(found.vector).all() and np.isfinite(found.covariance).all())


def _split(kind: str, quantity: str, changes: _Changes | None, tolerance: float, *, seen: bool) -> Split | None:
    if changes is None:
        return None
    spread = np.linalg.eigvalsh(changes.design.T @ changes.design)[0] / len(changes.names)
    if len(changes.names) < FEWEST[quantity] or spread < PARALLEL:
        return Split(_nothing(kind, quantity, TOO_FEW, changes.names), {})
    tried = (replace(changes, scatter=share * tolerance) for share in SCATTERS)
    agreed = next(((some, out) for some in tried if (out := _moved(some)) is not None), None)
    if agreed is None:
        return Split(_nothing(kind, quantity, UNCLEAR, changes.names), {})
    changes, out = replace(changes, scatter=max(agreed[0].scatter, NOTHING * tolerance)), agreed[1]
    inside = [i for i in range(len(changes.names)) if i not in out]
    gain = _fit(changes, inside).gain
    covariance = gain @ changes.covariance @ gain.T
    value = gain @ changes.y
    chi2 = float(value @ np.linalg.pinv(covariance, hermitian=True) @ value)
    motion = CommonMotion(
        kind=kind,
        quantity=quantity,
        state=SEPARATED,
        value=tuple(map(float, value)),
        covariance=tuple(tuple(map(float, row)) for row in covariance),
        p_value=float(stats.chi2.sf(chi2, len(value))) if seen else None,
        sensors=tuple(changes.names[i] for i in inside),
        left_out=tuple(changes.names[i] for i in out),
    )
    return Split(motion, _left(changes, gain))


def _nothing(kind: str, quantity: str, state: str, names: tuple[str, ...]) -> CommonMotion:
    return CommonMotion(kind, quantity, state, (), (), None, names, ())


def _left(changes: _Changes, gain: Array) -> dict[str, Deviation]:
    """What the common part leaves of each sensor."""
    rest = np.eye(len(changes.y)) - changes.design @ gain
    y, own, origin = rest @ changes.y, rest @ changes.own @ rest.T, rest @ changes.origin @ rest.T
    at = [changes.where([i]) for i in range(len(changes.names))]
    return {n: Deviation(y[w], own[np.ix_(w, w)], origin[np.ix_(w, w)]) for n, w in zip(changes.names, at, strict=True)}


def _fit(changes: _Changes, inside: list[int]) -> _Fit:
    """From the sensors ``inside``; the others are free.

    C is widened by S = s²·A·Aᵀ, which changes neither x nor what is left of it, but keeps a covariance that is singular
    along A (a frame held by the axes themselves) from being inverted as it is.
    """
    at, n = changes.where(inside), len(changes.y)
    a, c = changes.design[at], changes.covariance[np.ix_(at, at)]
    typical = max(float(np.trace(c)) / len(at), 1e-18)
    v = np.linalg.inv(c + typical * (a @ a.T) + 1e-12 * typical * np.eye(len(at)))
    g = np.linalg.solve(a.T @ v @ a, a.T @ v)
    w = v - v @ a @ g
    gain, weight = np.zeros((a.shape[1], n)), np.zeros((n, n))
    gain[:, at], weight[np.ix_(at, at)] = g, w
    return _Fit(gain, weight, float(changes.y @ weight @ changes.y))


def _moved(changes: _Changes) -> list[int] | None:
    """The sensors that moved on their own; None when that cannot be told."""
    m, out = len(changes.names), list[int]()
    limit = stats.chi2.isf(-np.expm1(np.log1p(-LEVEL) / m), changes.rows)
    while _is_majority(changes, out):
        inside = [i for i in range(m) if i not in out]
        fit = _fit(changes, inside)
        evidence = [_evidence(changes, fit, i) for i in inside]
        if max(evidence) <= limit:
            suspects = out + _rivals(changes, out, fit.chi2)
            return suspects if _is_majority(changes, suspects) else None
        out = [*out, inside[int(np.argmax(evidence))]]
    return None


def _is_majority(changes: _Changes, out: list[int]) -> bool:
    """Whether the sensors that remain say what the block did: more than half, and enough to agree on it."""
    m = len(changes.names)
    return 2 * (m - len(out)) > m and m - len(out) >= FEWEST_AGREEING[changes.rows]


FEWEST_AGREEING = {1: 2, 2: 3}
"""By rows a sensor: three axes that kept their angles, two scales that kept their ratio."""


def _evidence(changes: _Changes, fit: _Fit, sensor: int) -> float:
    """χ²: twice what the log likelihood gains when the sensor is left out."""
    at = changes.where([sensor])
    pull = fit.weight[at] @ changes.y
    return float(pull @ np.linalg.solve(fit.weight[np.ix_(at, at)], pull))


def _rivals(changes: _Changes, out: list[int], chi2: float) -> list[int]:
    """The sensors that could be left out instead of one of these and fit nearly as well."""
    inside = [i for i in range(len(changes.names)) if i not in out]

    def fits(kept: int, gone: int) -> bool:
        swapped = sorted([*(i for i in inside if i != kept), gone])
        return _fit(changes, swapped).chi2 - chi2 < RIVAL

    return [kept for kept in inside if any(fits(kept, gone) for gone in out)]
