"""The part of each rest in which gyros see no motion.

Accelerometers hardly see the first degree of a turn, so that rests found by them begin and end a little in the turns.
To the direction of a rest that is little; a gyro that is held to stand still there loses all of it.
"""

import numpy as np

from estimator.session import Array

BLOCK = 0.1
"""s over which a motion is looked for: short beside a turn, long beside a sample."""
LOUD = 25.0
"""Squared deviations per gyro, in those usual at rest, from which a block moves: five sigma, so that no quiet block of
a recording does."""
MARGIN = 2
"""Blocks that are cut further: a turn begins below what a block shows, and all of it that is lost shortens every turn,
as a scale factor does."""
ENDS = 4
"""Part of a rest, one over this at each end, that may be cut: what moves in the middle is no end of a turn."""
ROUNDING = 1e-9
"""Part of the largest reading below which a block's deviation is rounding of doubles."""
NORMAL = 1.4826
"""Sigma of a normal number in medians of its size."""


def quiet_ends(readings: Array, start: Array, stop: Array, step: float, *, labelled: bool) -> tuple[Array, Array]:
    """First samples (R,) and one past the last (R,) of the rests, cut where gyros see motion at their ends, and a
    `MARGIN` further; by that alone at quiet ends, unless people ``labelled`` them.

    readings : (N, m) of any unit, no gaps, ``step`` seconds apart; start, stop : (R,) of the rests.
    """
    length = max(round(BLOCK / step), 1)
    blocks = [blocked(readings[a:b], length) for a, b in zip(start.tolist(), stop.tolist(), strict=True)]
    usual = NORMAL * np.median(np.abs(np.concatenate(blocks)), axis=0)
    usual = np.maximum(usual, ROUNDING * np.abs(readings).max(axis=0))
    cuts = np.array([loud_ends(b, np.where(usual > 0, usual, 1.0)) for b in blocks])
    most = (stop - start) // (ENDS * length)
    cuts = np.where((cuts > 0) | (not labelled), np.minimum(cuts + MARGIN, most[:, None]), 0)
    return start + length * cuts[:, 0], stop - length * cuts[:, 1]


def blocked(rest: Array, length: int) -> Array:
    """(n, m) means of blocks of one rest (r, m), counted from both ends, less their median; unit of the readings."""
    count = max(len(rest) // length, 1)
    half = count // 2 * length
    whole = np.concatenate([rest[:half], rest[len(rest) - (count * length - half) :]])[: count * length]
    means = whole.reshape(count, -1, rest.shape[1]).mean(axis=1)
    return np.asarray(means - np.median(means, axis=0))


def loud_ends(blocks: Array, usual: Array) -> tuple[int, int]:
    """Blocks to cut from both ends of one rest (n, m); ``usual`` (m,) sigma of a block, in its unit."""
    loud = ((blocks / usual) ** 2).mean(axis=1) > LOUD
    at = np.flatnonzero(loud)
    end = len(loud) // ENDS
    first, last = at[at < end], at[at >= len(loud) - end]
    return int(first.max(initial=-1)) + 1, len(loud) - int(last.min(initial=len(loud)))
