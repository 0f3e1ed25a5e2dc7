"""Chooses still orientations that complete a set so that it identifies everything, from the block's nominal axes.

An orientation's share of the information is the Schur complement of its own two unknown turns; shares add up.
Orientations are taken one by one from a fine grid of directions, each the one that raises ln|information + plausible
range| most: a direction not yet determined counts for most. What a set lacks does not depend on the number of sensors
(the readings lie on an ellipsoid), so of a large block a few sensors are asked.
"""

import numpy as np
from scipy.linalg import qr

from estimator.calibration.free.information import movable, unseen_below
from estimator.calibration.free.model import ModelRows, Unknowns, linearise
from estimator.parameters import PLAUSIBLE
from estimator.session import Array

GRID = 120
"""Directions to choose from: 18° apart. A neighbour of the best one adds nearly as much; more would only cost
time."""

LEAST = 9
"""Generic orientations that identify everything but the quadratic terms."""

MOST_CANDIDATES = 12
"""Sensors of a block whose axes are candidates, to bound the work, which grows with their cube: see the head."""

NOISE = 1e-5
"""g; of a reading where none is stated: 10 µg, a good instrument's. The rank does not depend on it."""


def planned_rows(
    axes: Array, directions: Array, noise: float = NOISE, direction_sigma: float | None = None
) -> tuple[ModelRows, Unknowns]:
    """Orientations (R, 3) still to be measured by sensors along axes (m, 3), both unit vectors, nominal parameters.

    noise : one sigma of a reading, g; direction_sigma : rad, None where directions will not be stated.
    """
    R = len(directions)
    prior = np.full(R, 0.0 if direction_sigma is None else direction_sigma**-2.0)
    stated = directions if direction_sigma is not None else np.zeros((R, 3))
    zero = np.zeros(len(axes))
    rows = ModelRows(directions @ axes.T, np.full((R, len(axes)), noise), stated, prior, axes)
    return rows, Unknowns(zero, zero, zero, axes, directions)


def shares(rows: ModelRows, unknowns: Unknowns) -> Array:
    """(R, 5 m, 5 m) information that each orientation adds, dimensionless elements."""
    linear = linearise(rows, unknowns)
    R, m = rows.y.shape
    full = np.zeros((R, m, 5, m, 5))
    sensors = np.arange(m)
    full[:, sensors, :, sensors] = np.einsum("rmi,rmj->mrij", linear.local, linear.local)
    return full.reshape(R, 5 * m, 5 * m) - linear.coupling @ linear.inverse @ np.swapaxes(linear.coupling, 1, 2)


def grid(count: int = GRID) -> Array:
    """(count, 3) unit vectors, dimensionless, evenly spread over the sphere (golden spiral)."""
    k = np.arange(count) + 0.5
    height, turn = 1 - 2 * k / count, np.pi * (1 + 5**0.5) * k
    side = np.sqrt(1 - height**2)
    return np.stack([side * np.cos(turn), side * np.sin(turn), height], axis=-1)


def candidate_directions(axes: Array) -> Array:
    """At most `MOST_CANDIDATES` axes (m, 3), unit vectors, of the block: three that span space best, and others."""
    if len(axes) <= MOST_CANDIDATES:
        return axes
    best = qr(axes.T, pivoting=True, mode="r")[1][:3]
    others = np.setdiff1d(np.arange(len(axes)), best)[: MOST_CANDIDATES - 3]
    return np.asarray(axes[np.sort(np.concatenate([best, others]))])


def completion(
    axes: Array,
    directions: Array,
    *,
    noise: float = NOISE,
    quadratic: bool = False,
    direction_sigma: float | None = None,
    at_least: int = 0,
) -> Array:
    """(k, 3) unit vectors, block axes, that bring a set to full rank; none where it has it, or cannot get it.

    Parameters
    ----------
    axes : (m, 3) nominal input axes, unit vectors.
    directions : (R, 3) of the specific force in the set's orientations, unit vectors.
    noise : one sigma of a reading, g.
    quadratic : whether the second-order terms are estimated too.
    direction_sigma : one sigma of the directions, rad, where they are stated.
    at_least : orientations to add even where fewer complete the set.
    """
    known = candidate_directions(axes)
    rows, unknowns = planned_rows(known, directions, noise, direction_sigma)
    candidates = grid()
    basis = movable(rows, unknowns, quadratic)
    information = basis.T @ shares(rows, unknowns).sum(axis=0) @ basis
    offered = basis.T @ shares(*planned_rows(known, candidates, noise, direction_sigma)) @ basis
    ridge = PLAUSIBLE**-2 * np.eye(basis.shape[1])
    chosen: list[int] = []
    for _ in range(max(at_least, 4 * LEAST)):
        values = np.linalg.eigvalsh(information)
        if len(chosen) >= at_least and values[0] > unseen_below(values):
            break
        best = int(np.argmax(np.linalg.slogdet(information + offered + ridge)[1]))
        chosen.append(best)
        information = information + offered[best]
    return candidates[chosen].reshape(-1, 3)
