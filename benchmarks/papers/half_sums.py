"""The estimator that the printed accuracy formulas are about, simulated from the geometry alone: no package model.

Half sums and half differences of the two runs, (18), (20), (22)–(24), c = 0 and not estimated.
"""

import numpy as np

from benchmarks.papers.printed import Accuracy, Conditions
from estimator.session import Array


def applied(c: Conditions, rng: np.random.Generator, lift: Array, across: Array) -> Array:
    """(trials, N, 3) applied vectors of one run, platform axes, under the stand's errors (trials,)."""
    beta = 2 * np.pi * np.arange(c.positions) / c.positions
    beta = beta + rng.normal(0, c.stand.beta, (len(lift), c.positions))
    y, z = np.sin(c.alpha + lift)[:, None], np.cos(c.alpha + lift)[:, None]
    sin, cos, x = np.sin(beta), np.cos(beta), across[:, None]
    return c.magnitude * np.stack([cos * x - sin * z, y + 0 * beta, sin * x + cos * z], axis=-1)


def simulated(axes: Array, c: Conditions, trials: int, seed: int) -> Accuracy:
    """Mean squared errors of the sensors (m, 3), platform axes, K = 1, over simulated sessions."""
    rng = np.random.default_rng(seed)
    lift = rng.normal(0, 1, trials) * np.sqrt(c.raise_variance)
    across = rng.normal(0, c.stand.theta_y, trials)
    shape = (trials, c.positions, len(axes))
    direct, flipped = (
        (applied(c, rng, lift, across) * sign) @ axes.T + rng.normal(0, np.hypot(c.noise, c.bias_variation), shape)
        for sign in (np.ones(3), np.array([-1.0, -1.0, 1.0]))
    )
    total, half = (direct + flipped) / 2, (direct - flipped) / 2
    beta = 2 * np.pi * np.arange(c.positions) / c.positions
    reach = 2 / (c.positions * c.magnitude * np.cos(c.alpha))
    s1 = reach * np.einsum("j,tjm->tm", -np.sin(beta), half)
    s3 = reach * np.einsum("j,tjm->tm", np.cos(beta), total)
    s = np.stack([s1, half.mean(axis=1) / (c.magnitude * np.sin(c.alpha)), s3], axis=-1)
    K = np.linalg.norm(s, axis=-1)
    turned = ((s / K[..., None] - axes) ** 2).sum(axis=-1)
    return Accuracy(*(e.mean(axis=0) for e in ((K - 1) ** 2, total.mean(axis=1) ** 2, turned)))
