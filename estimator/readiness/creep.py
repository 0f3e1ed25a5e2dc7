"""A fixture that creeps: every sensor drifts, and all of it is as if the block turned.

A turn by a small ω moves the specific force in the block by f × ω, and the reading of the axis e by e·(f × ω). Of m
sensors it explains what lies in two dimensions: what is left of their drifts is χ² of m − 2 where nothing but a turn
is. Drifts of the sensors' own lie anywhere: that all but a share q of their squares falls into two given dimensions of
m has the chance q^{(m−2)/2}.
"""

import numpy as np

from estimator.session import Array
from estimator.significance import p_value

CHANCE = 1e-3
"""Chance with which drifts of the sensors' own may look like a turn."""
LEAVES = 0.05
"""Chance from which what a turn leaves is noise."""
FEWEST = 4
"""Sensors from which a turn is distinguished from their own drifts: three leave but one number."""


def turn(axes: Array, force: Array, drift: Array, error: Array) -> float | None:
    """rad by which a block turns that explains ``drift`` (m,), m/s², known to ``error`` (m,); None where none does.

    ``axes`` (m, 3) unit vectors; ``force`` (3,) m/s², specific force, block axes.
    """
    if len(axes) < FEWEST or not drift.any():
        return None
    pattern = np.cross(axes, force)  # e·(f × ω) = ω·(e × f)
    omega = np.linalg.lstsq(pattern, drift, rcond=1e-6)[0]
    residual = drift - pattern @ omega
    by_chance = ((residual**2).sum() / (drift**2).sum()) ** (len(axes) / 2 - 1)
    is_turn = by_chance < CHANCE and p_value(((residual / error) ** 2).sum(), len(axes) - 2) > LEAVES
    return float(np.linalg.norm(omega)) if is_turn else None
