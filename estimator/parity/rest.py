"""Whether a block of a recording is at rest in truth, and not only as quiet as the quietest.

A smooth flight is quiet, and so is a steady turn. At rest the specific force has gravity's size, keeps its direction,
and shakes no more than the sensors' own noise makes it seem, or hardly.
"""

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import unit
from estimator.parity.ledger import Blocks
from estimator.parity.reference import Reference
from estimator.session import Array

Mask = NDArray[np.bool_]
"""One bool a block."""

LEVEL = 0.01
"""Relative difference of the vector's size from gravity at which a block may be at rest: a bank of eight degrees."""
SLOW = 0.02
"""rad/s; turn of the specific force below which a block may be at rest: a degree in a second."""
CALM = 0.1
"""m/s²; shaking of the vector below which a block may be at rest: quieter than vehicles under way."""
NOISY = 3.0
"""Variance of the vector within a block, in what the sensors' own noise makes of it, that still is no shaking."""


def resting(blocks: Blocks, quiet: Mask, reference: Reference, norm: float | None, rate: float | None) -> Mask:
    """(B,) bool: whether at rest.

    Parameters
    ----------
    quiet : (B,) bool, as quiet as the quietest.
    norm : g, m/s²; None for gyros, which rest where they are quiet.
    rate : of the samples, Hz; None for rows that are averages.
    """
    if norm is None:
        return quiet
    level = np.abs(np.linalg.norm(reference.vector(blocks.mean), axis=1) - norm) < LEVEL * norm
    shake = blocks.shake[:, :3].sum(axis=1)
    noise = NOISY * blocks.own * np.trace(np.linalg.inv(reference.axes.T @ reference.axes))
    calm = shake <= np.maximum(CALM**2, noise)
    return np.asarray(quiet & level & calm & (turning(blocks, reference, rate) < SLOW))


def turning(blocks: Blocks, reference: Reference, rate: float | None) -> Array:
    """(B,) rate at which the specific force turns from block to block, rad/s; 0 for rows that are averages."""
    turns = np.zeros(len(blocks) + 1)
    if rate is not None:
        apart = np.linalg.norm(np.diff(unit(reference.vector(blocks.mean)), axis=0), axis=1)
        middles = 0.5 * (blocks.samples[1:] + blocks.samples[:-1]) / rate
        turns[1:-1] = np.where(np.diff(blocks.first) == 1, apart / middles, 0.0)
    return np.maximum(turns[1:], turns[:-1])
