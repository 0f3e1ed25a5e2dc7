"""The change since the reference that all sensors of a block share, separated from what each sensor did alone.

A block that sits otherwise in its fixture, a fixture or a stand that has turned, a wrong gravity: all of them move
every sensor at once and say nothing of any sensor. The changes y of all axes (scales) since the reference session are

    y = A·x + s + ε,    cov ε = C, the total covariance of both sessions, sensors correlated

axes     the block turned by a rotation R, exactly, however far. y (2 m) is the angle from the turned axes R·e of the
         reference along their turned tangents R·p, R·o; x (3) the small turn that is still missing. It moves R·e by
         x × R·e, so the row of a turned tangent t is (R·e × t)ᵀ. R ← exp[x×]·R until nothing is missing (Gauss–Newton
         on the rotations), from a start that single axes hardly drag. Reported is the rotation vector θ of R, whose
         covariance is J⁻¹·cov x·J⁻ᵀ with J the left Jacobian.
scales   y (m) relative changes, x the common factor (1): A is a column of ones.
s        what single sensors did: zero but for those that are left out.

x is the generalised least squares estimate from the sensors that agree. A sensor that is left out has no part in x: its
drift does not smear into the others, nor the common part into it. What each sensor did by itself is its change beside
an x that it has no part in, averaged over who else may have moved (`who_moved`).

Sensors of a healthy block wander a little, each on its own, often by more than a good stand's uncertainty. Who moved is
asked with C + τ²·1, τ the smallest part of the tolerance, up to a fifth, with which a majority agrees: a drift is left
out while it is small. x is then taken with τ a tenth of the tolerance at least, and is as uncertain as that makes it.
Where the noise is known to ν degrees of freedom only, χ² over its rows is Fisher's F.

Left out is, one after another, the sensor whose own change raises the likelihood most, while twice the gain of the log
likelihood, (Eᵀ·W·y)ᵀ(EᵀWE)⁻¹(EᵀWy) with W = V − VA(AᵀVA)⁻¹AᵀV (chi-square with as many degrees of freedom as the
sensor has rows), is beyond the level α = 0.1 % over all m sensors (Šidák). A sensor that would do instead of one of
them nearly as well (χ² higher by less than 2·ln 100) may be the one that moved and is left out too. The sensors that
remain must be more than half of all; if they are not, nobody can tell who moved: nothing is taken off and every sensor
is judged on its whole change. So it is on a common factor beyond what the applied vector can have done to all scales
(`common_factors`: gravity at one place is the same), at the same level: it is the unit's, or of what reads it. Axes of
fewer than four sensors, and scales of fewer than three, never tell: of two axes that have parted, either may have
moved.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.applied_vector import common_factors
from estimator.coverage import known_to
from estimator.health.changes import AxisPairs, Changes, axis_pairs, scale_changes
from estimator.health.deviation import Deviation
from estimator.health.moved import LEVEL, fit, moved
from estimator.health.who_moved import Sets, residuals
from estimator.results import NOMINAL_AXES, Calibration
from estimator.rotations import common_turn, left_jacobian, turn_of, vector_of
from estimator.session import Array
from estimator.significance import p_value

AXES, SCALES = "axes", "scales"
SEPARATED, TOO_FEW, UNCLEAR, BEYOND = "separated", "too-few-sensors", "unclear", "beyond-input"
SCATTERS = (0.0, 0.025, 0.05, 0.1, 0.2)
"""τ as parts of the tolerance, the least first, because it leaves the smallest drifts out; beyond a fifth a drift of
the whole tolerance, 4.2 τ at the level, would pass for wander."""
NOTHING = 0.1
"""The wander of a single sensor that concerns nobody, as a part of the tolerance: its decision hardly feels it."""
FEWEST = {AXES: 4, SCALES: 3}
"""Sensors that it takes to tell a common change from a single one: of three axes (two scales) that parted any may have
moved."""
PARALLEL = 1e-3
"""Smallest eigenvalue of AᵀA per sensor below which a turn about them does not show: the mean sin² of the
axes' angles to one line (1.8° root mean square)."""
ROUNDS = 10
"""Rounds of Gauss–Newton on the rotations; two are usual."""
NEGLIGIBLE = 1e-12
"""rad (2e-7″): a missing turn that changes no figure."""


@dataclass(frozen=True)
class CommonMotion:
    """The change of axes, or of scales, that all sensors of one kind have shared since the reference."""

    kind: str
    """``accelerometer`` or ``gyroscope``."""
    quantity: str
    """``axes`` or ``scales``."""
    state: str
    """``separated``; otherwise nothing was taken off: ``too-few-sensors``, ``unclear`` which of them moved, or a common
    factor that is ``beyond-input``, more than the applied vector can have changed."""
    value: tuple[float, ...]
    """Rotation vector in block axes, rad (3), or relative change of all scales (1); empty where it is not known."""
    covariance: tuple[tuple[float, ...], ...]
    """Total covariance of the value, from both sessions."""
    p_value: float | None
    """Chance of a common change at least this large when nothing moved together; None where the block's frame is held
    by the axes themselves, so that a common turn cannot be seen."""
    sensors: tuple[str, ...]
    """Names of the sensors that the common change rests on."""
    left_out: tuple[str, ...]
    """Sensors that moved on their own, or cannot be distinguished from one that did; the most evident first."""

    @property
    def size(self) -> float:
        """Angle of the rotation, rad, or the relative change with its sign."""
        return size_of(self.quantity, self.value)

    @property
    def sigma(self) -> float:
        """One sigma of the size."""
        return sigma_of(self.value, self.covariance)


def size_of(quantity: str, value: Sequence[float]) -> float:
    """Angle of a rotation vector (3,), rad, or the relative change of all scales (1,) with its sign, dimensionless."""
    return float(np.linalg.norm(value)) if quantity == AXES else float(value[0])


def sigma_of(value: Sequence[float], covariance: Sequence[Sequence[float]]) -> float:
    """One sigma of the size of a common change (k,), rad or relative: along its direction, by its covariance (k, k)."""
    vector, length = np.array(value), float(np.linalg.norm(value))
    along = vector / length if length > 0 else np.eye(len(vector))[0]
    return float(np.sqrt(along @ np.array(covariance) @ along))


@dataclass(frozen=True, eq=False)
class Split:
    """The common part, and the residual of each sensor."""

    motion: CommonMotion
    residuals: dict[str, Deviation]
    """Residual of each sensor, by name; empty unless the common part was separated."""


def common_motion(
    current: Calibration, reference: Calibration, tolerances: Mapping[tuple[str, str], float] | None = None
) -> tuple[Split, ...]:
    """The splits of every kind of sensor that both sessions hold: axes, then scales; SI, block axes.

    ``tolerances`` by (kind, ``axis`` or ``scale``) say what counts as nothing; without one only noise does.
    """
    allowed = tolerances or {}
    is_framed = NOMINAL_AXES not in (current.gauge, reference.gauge)
    splits = []
    for kind in dict.fromkeys(sensor.kind for sensor in current.sensors):
        axes, scales = axis_pairs(current, reference, kind), scale_changes(current, reference, kind)
        if axes is not None:
            splits.append(split_axes(kind, axes, allowed.get((kind, "axis"), 0.0), is_seen=is_framed))
        if scales is not None:
            bounds = common_factors(kind, current.site, reference.site)
            splits.append(_split_scales(kind, scales, allowed.get((kind, "scale"), 0.0), bounds))
    return tuple(splits)


@dataclass(frozen=True, eq=False)
class _Agreed:
    """The common change by the sensors that agree on it."""

    changes: Changes
    excluded: list[int]
    """Sensors that take no part."""
    gain: Array
    """(k, m r) x = gain·y, dimensionless."""
    sets: Sets
    """The sets of sensors that may have moved, over which each sensor's own change is averaged."""

    @property
    def value(self) -> Array:
        """(k,) x, rad or relative."""
        return self.gain @ self.changes.y

    @property
    def covariance(self) -> Array:
        """(k, k) covariance of x, rad² or relative²."""
        return self.gain @ self.changes.covariance @ self.gain.T


def split_axes(kind: str, pairs: AxisPairs, tolerance: float, *, is_seen: bool) -> Split:
    """The common turn and the rest; ``is_seen`` says whether a common turn shows at all."""
    if not _is_separable(AXES, pairs.about(np.eye(3))):
        return Split(_nothing(kind, AXES, TOO_FEW, pairs.names), {})
    turn = common_turn(pairs.origins, pairs.axes)
    agreed = _agreed(pairs.about(turn), tolerance)
    for _ in range(ROUNDS):
        if agreed is None or np.linalg.norm(agreed.value) < NEGLIGIBLE:
            break
        turn = turn_of(agreed.value) @ turn
        agreed = _agreed(pairs.about(turn), tolerance)
    if agreed is None:
        return Split(_nothing(kind, AXES, UNCLEAR, pairs.names), {})
    value = vector_of(turn_of(agreed.value) @ turn)
    slope = np.linalg.inv(left_jacobian(value))
    return _separated((kind, AXES), agreed, value, slope @ agreed.covariance @ slope.T, is_seen=is_seen)


def _split_scales(kind: str, changes: Changes, tolerance: float, bounds: tuple[float, float]) -> Split:
    """The common factor and the rest; ``bounds``: the relative changes that the applied vector can account for."""
    if not _is_separable(SCALES, changes):
        return Split(_nothing(kind, SCALES, TOO_FEW, changes.names), {})
    agreed = _agreed(changes, tolerance)
    if agreed is None:
        return Split(_nothing(kind, SCALES, UNCLEAR, changes.names), {})
    split = _separated((kind, SCALES), agreed, agreed.value, agreed.covariance, is_seen=True)
    excess = float(agreed.value[0] - np.clip(agreed.value[0], *bounds)) / split.motion.sigma
    if p_value(excess**2, 1, known_to(agreed.changes.dof)) >= LEVEL:
        return split
    return Split(replace(split.motion, state=BEYOND), {})


def _is_separable(quantity: str, changes: Changes) -> bool:
    """Whether there are sensors enough, and not all alike."""
    spread = np.linalg.eigvalsh(changes.design.T @ changes.design)[0] / len(changes.names)
    return len(changes.names) >= FEWEST[quantity] and bool(spread >= PARALLEL)


def _agreed(changes: Changes, tolerance: float) -> _Agreed | None:
    """Finds the sensors that moved at the smallest scatter with which a majority agrees; None where it cannot be
    decided.
    """
    tried = (replace(changes, scatter=share * tolerance) for share in SCATTERS)
    agreement = next(((some, excluded) for some in tried if (excluded := moved(some)) is not None), None)
    if agreement is None:
        return None
    changed, excluded = replace(changes, scatter=max(agreement[0].scatter, NOTHING * tolerance)), agreement[1]
    gain = fit(changed, [i for i in range(len(changed.names)) if i not in excluded]).gain
    return _Agreed(changed, excluded, gain, Sets(agreement[0], changed, tolerance))


def _separated(part: tuple[str, str], agreed: _Agreed, value: Array, covariance: Array, *, is_seen: bool) -> Split:
    """A common change ``value`` (k,) with its covariance (k, k), and what it leaves; ``part``: kind and quantity."""
    names = agreed.changes.names
    chi2 = float(value @ np.linalg.pinv(covariance, hermitian=True) @ value)
    motion = CommonMotion(
        kind=part[0],
        quantity=part[1],
        state=SEPARATED,
        value=tuple(map(float, value)),
        covariance=tuple(tuple(map(float, row)) for row in covariance),
        p_value=float(p_value(chi2, len(value), known_to(agreed.changes.dof))) if is_seen else None,
        sensors=tuple(name for i, name in enumerate(names) if i not in agreed.excluded),
        left_out=tuple(names[i] for i in agreed.excluded),
    )
    return Split(motion, residuals(agreed.sets, agreed.excluded))


def _nothing(kind: str, quantity: str, state: str, names: tuple[str, ...]) -> CommonMotion:
    """A result that takes nothing off, with the reason as its ``state``."""
    return CommonMotion(kind, quantity, state, (), (), None, names, ())
