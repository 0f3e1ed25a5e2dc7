"""Effects of motion on sound sensors of a block, in the means of blocks: lever arms, delays, vibration.

A sensor with axis e at r, whose samples come τ late, feels

    e·(n + (ω̇× + ω×ω×)·r − τ·ṅ) + κ·eᵀ·C·e

with C the covariance of n within the block. All is linear in the unknown r, τ and κ, sensor by sensor; what is common
to all sensors is motion and leaves no trace in parity. Each unknown has a size that it will not exceed much, one sigma.

Without gyros ω is not known. Then each sensor feels Ω²·x with x = (1, n/g) and four unknown lengths: a rate that goes
with the specific force in any way. Ω² is what the turning of the specific force shows; and beside it, with lengths of
its own, `UNSEEN_RATE` squared while the block is not at rest, because a coordinated turn leaves the specific force as
it was.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.parity.blocks import ENOUGH_STILL, Mask, turning
from estimator.parity.ledger import Blocks, pairs
from estimator.parity.reference import ParityReference
from estimator.session import Array

SIZE = 0.1
"""m; how far from one another sensors sit whose positions are not stated: a block of two hands' width."""
STATED = 5e-4
"""m; error of a stated position: what a drawing says of the point in a sensor that feels."""
RATE_ERROR = 0.03
"""Relative error of a rate by nominal gyros, which acts like one of the lever arm twice as large."""
RATE_ZERO, REST_ZERO = 0.02, 0.002
"""rad/s; zero of gyros: a degree per second, as of the cheapest, and a tenth where the recording holds rest."""
MOST_ZERO = 0.05
"""rad/s; a mean rate at rest beyond this is no zero: the block turns slowly."""
UNSEEN_RATE = 0.3
"""rad/s; of a turn that the specific force does not show: six times a standard turn. Faster ones are rolls or loops."""
DELAY_SAMPLES, DELAY_TIME = 1.0, 2e-3
"""Delay of one channel beside another, the larger one: multiplexed converters, and filters of unlike corner (s)."""
RECTIFICATION = 1e-4
"""1/(m/s²); shift of the zero by the variance of vibration: 1 mg/g², as of an inexpensive sensor."""


@dataclass(frozen=True, eq=False)
class ParityNuisance:
    """k unknowns u with a standard normal prior each, that move the input of sensor i by Σ u·(signals·c). B blocks."""

    signals: Array
    """(B, K) courses that move the inputs, in the units that follow from their coefficients."""
    coefficient: Array
    """(k, K) c, of each unknown at one sigma; signals times it is m/s² (rad/s)."""
    sensor: NDArray[np.intp]
    """(k,) sensor whose input each unknown moves."""
    known: Array
    """(B, m) inputs due to the stated positions, m/s²."""

    def moved(self, u: Array) -> Array:
        """(B, m) change of the inputs by the unknowns (k,), m/s² (rad/s)."""
        by_sensor = np.zeros((self.known.shape[1], self.signals.shape[1]))
        np.add.at(by_sensor, self.sensor, u[:, None] * self.coefficient)
        return np.asarray(self.signals @ by_sensor.T)


def nuisance_of(
    blocks: Blocks, rest: Mask, reference: ParityReference, norm: float | None, rate: float | None, *, arms: bool = True
) -> ParityNuisance:
    """The nuisance in the blocks of a recording.

    Parameters
    ----------
    rest : (B,) bool.
    norm : g, m/s²; None for gyros, which feel no lever arms.
    rate : of the samples, Hz; None for rows that are averages.
    arms : False where the sensors are known to sit in one point.
    """
    parts = [_delays(blocks, reference, rate)]
    known = np.zeros_like(blocks.mean)
    if norm is not None:
        parts.append(_rectified(blocks, reference))
    if norm is not None and arms:
        if blocks.spin.shape[1]:
            with_arms, known = _lever_arms(blocks, rest, reference, rate)
            parts.extend(with_arms)
        else:
            parts.append(_unseen_turns(blocks, rest, turning(blocks, reference, rate), reference, norm))
    return _joined(parts, known)


Part = tuple[Array, Array, NDArray[np.intp]]
"""Signals (B, K), coefficients (k, K) and sensors (k,) of one kind of unknown."""


def _joined(parts: list[Part], known: Array) -> ParityNuisance:
    widths = [part[0].shape[1] for part in parts]
    starts = np.concatenate([[0], np.cumsum(widths)])
    blocks = []
    for (_, coefficient, _), start in zip(parts, starts, strict=False):
        wide = np.zeros((len(coefficient), starts[-1]))
        wide[:, start : start + coefficient.shape[1]] = coefficient
        blocks.append(wide)
    return ParityNuisance(
        signals=np.hstack([part[0] for part in parts]),
        coefficient=np.vstack(blocks),
        sensor=np.concatenate([part[2] for part in parts]),
        known=known,
    )


def _delays(blocks: Blocks, reference: ParityReference, rate: float | None) -> Part:
    """A mean of samples that come one later has lost its last and won the one before its first."""
    m = len(reference.names)
    delay = max(DELAY_SAMPLES, DELAY_TIME * (rate or 0.0))
    return -blocks.gain / blocks.samples[:, None], delay * reference.axes, np.arange(m)


def _rectified(blocks: Blocks, reference: ParityReference) -> Part:
    x, y, z = reference.axes.T
    along = np.column_stack([x * x, y * y, z * z, 2 * x * y, 2 * x * z, 2 * y * z])
    return blocks.shake, RECTIFICATION * along, np.arange(len(along))


def arm_matrix(blocks: Blocks, zero: Array, rate: float | None) -> Array:
    """(B, 3, 3) mean of ω̇× + ω×ω× over each block, 1/s², of rates freed of their zero (3,), rad/s."""
    crossed = pairs(blocks.spin + zero) - pairs(blocks.spin) - pairs(zero)
    xx, yy, zz, xy, xz, yz = (blocks.spin_square - crossed + pairs(zero)).T
    ax, ay, az = (blocks.spin_gain * (rate or 0.0) / blocks.samples[:, None]).T
    rows = [[-yy - zz, xy - az, xz + ay], [xy + az, -xx - zz, yz - ax], [xz - ay, yz + ax, -xx - yy]]
    return np.moveaxis(np.array(rows), 2, 0)


def _lever_arms(blocks: Blocks, rest: Mask, reference: ParityReference, rate: float | None) -> tuple[list[Part], Array]:
    """Unknowns of lever arms where the rate is known, and what stated positions feel, (B, m) m/s²."""
    m, e = len(reference.names), reference.axes
    zero, doubt = _rate_zero(blocks, rest)
    matrix = arm_matrix(blocks, zero, rate)
    distance, spread = reach(reference)
    lever = np.einsum("ij,lk->iljk", e, np.eye(3)).reshape(3 * m, 9) * np.repeat(spread, 3)[:, None]
    shifted = 2 * doubt * np.repeat(distance, 3)[:, None] * np.tile(np.eye(3), (m, 1))
    who = np.repeat(np.arange(m), 3)
    known = np.zeros_like(blocks.mean)
    if reference.position is not None:
        from_middle = reference.position - reference.position.mean(axis=0)
        known = np.einsum("ij,bjl,il->bi", e, matrix, from_middle)
    return [(matrix.reshape(-1, 9), lever, who), (blocks.spin - zero, shifted, who)], known


def _rate_zero(blocks: Blocks, rest: Mask) -> tuple[Array, float]:
    """(3,) zero of the rates as the rest shows it, and what is not known of it, rad/s."""
    if rest.sum() < ENOUGH_STILL:
        return np.zeros(3), RATE_ZERO
    zero = blocks.spin[rest].mean(axis=0)
    return (zero, REST_ZERO) if np.linalg.norm(zero) < MOST_ZERO else (np.zeros(3), RATE_ZERO)


def reach(reference: ParityReference) -> tuple[Array, Array]:
    """(m,) largest lengths of the lever arms, and (m,) one sigma of the unknown part of each component, m."""
    if reference.position is None:
        return np.full(len(reference.names), SIZE), np.full(len(reference.names), SIZE)
    length = np.linalg.norm(reference.position - reference.position.mean(axis=0), axis=1)
    return length + STATED, STATED + 2 * RATE_ERROR * length


def _unseen_turns(blocks: Blocks, rest: Mask, turns: Array, reference: ParityReference, norm: float) -> Part:
    """Twice four unknown lengths a sensor, where the rate is not known."""
    m = len(reference.names)
    n = reference.vector(blocks.mean)
    squares = np.where(rest, 0.0, np.stack([turns**2, np.full(len(n), UNSEEN_RATE**2)]))
    x = np.column_stack([np.ones(len(n)), n / norm])
    length, _ = reach(reference)
    return np.hstack([s[:, None] * x for s in squares]), np.kron(length[:, None], np.eye(8)), np.repeat(np.arange(m), 8)
