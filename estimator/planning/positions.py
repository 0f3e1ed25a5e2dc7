"""D-optimal positions of the head beside the paper's equal steps.

Theory
------
With x_ik the whitened Jacobian of sensor i at candidate k (a β of a fine grid in one of the runs), a schedule of rows
j has the information M_i = Σ_j x_ij x_ij'. Positions are exchanged one by one for the candidate that raises Σ_i ln|M_i|
most (Fedorov 1972), where the exchange of row j for candidate k multiplies |M_i| by
(1 + d_kk)(1 − d_jj) + d_jk², d = x'M⁻¹x. The D-efficiency of a schedule is exp of the difference in Σ ln|M| per
parameter: with an efficiency of 0.98 equal steps need 2 % more readings for the same confidence volume.
The row's β error counts as independent noise here; the stand's constant errors do not depend on the positions.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from estimator.applied_vector import stand_geometry
from estimator.codec import DEGREES, RUN, Document
from estimator.forward import jacobian, projected, slope
from estimator.parameters import PLAUSIBLE, nominal
from estimator.session import Array, CalibrationSession

GRID = 180
"""Candidates a run: steps of 2°, over which the information hardly changes."""

GOLDEN = 0.618034
"""Fraction of the golden ratio: its multiples scatter evenly, whatever their number."""

PASSES = 30
"""Most passes over all rows; a handful is usual, and this ends what would go in circles by rounding."""
SLIGHT = 1e-6
"""Gain in ln|M| below which an exchange is not worth it: a millionth of the confidence volume."""


@dataclass(frozen=True, eq=False)
class OptimalPositions(
    Document,
    keys={"beta": "beta_deg", "flipped": "run", "efficiency": "equal_steps_efficiency"},
    forms={"beta": DEGREES, "flipped": RUN},
):
    """Positions found by exchange. R rows, as many as the equal steps have."""

    beta: Array
    """(R,) rad, rising within a run."""
    flipped: NDArray[np.bool_]
    """(R,)"""
    efficiency: float
    """D-efficiency of equal steps, 1 when nothing is better."""
    different: int
    """Number of different positions among the rows; repeated ones tell less of causes that the model lacks."""


def whitened(schedule: CalibrationSession, beta: Array, flipped: Array, sigma: Array) -> Array:
    """(R, m, 5) Jacobians over the noise, in standard errors per dimensionless element.

    beta : (R,) rad; flipped : (R,) bool; sigma : (m,) noise at the input, m/s² (rad/s), joined by the row's β error.
    """
    rows = replace(schedule, beta=beta, flipped=flipped)
    geometry, p = stand_geometry(rows), nominal(schedule.sensors)
    swing = slope(p, geometry.n) * projected(p.axis, geometry.beta) * geometry.beta_sigma
    return jacobian(p, geometry.n, geometry.norm) / np.sqrt(sigma**2 + swing**2)[..., None]


def log_information(chosen: Array) -> float:
    """Σ_i ln|M_i| of whitened rows (R, m, 5), standard errors, what is not seen held at its plausible range."""
    M = np.einsum("rmi,rmj->mij", chosen, chosen) + PLAUSIBLE**-2 * np.eye(5)
    return float(np.linalg.slogdet(M)[1].sum())


def exchanged(rows: NDArray[np.intp], candidates: Array) -> NDArray[np.intp]:
    """Rows (R,), numbers of candidates (C, m, 5), standard errors, after exchanges that raise the information."""
    rows, per_sensor = rows.copy(), np.ascontiguousarray(candidates.swapaxes(0, 1))
    M = np.einsum("rmi,rmj->mij", candidates[rows], candidates[rows]) + PLAUSIBLE**-2 * np.eye(5)
    spread, leverage = _leverages(per_sensor, M)
    for _ in range(PASSES):
        gained = 0.0
        for place, old in enumerate(rows):
            across = (spread @ candidates[old][..., None])[..., 0]
            factor = (1 + leverage) * (1 - leverage[:, old, None]) + across**2
            gains = np.log(np.maximum(factor, 1e-12)).sum(axis=0)
            best = int(np.argmax(gains))
            if gains[best] > SLIGHT:
                x, y = candidates[best], candidates[old]
                M = M + x[:, :, None] * x[:, None, :] - y[:, :, None] * y[:, None, :]
                spread, leverage = _leverages(per_sensor, M)
                rows[place], gained = best, gained + float(gains[best])
        if gained <= SLIGHT:
            break
    return rows


def _leverages(per_sensor: Array, M: Array) -> tuple[Array, Array]:
    """x'M⁻¹ (m, C, 5) and d_kk (m, C) of candidates x (m, C, 5), standard errors, by information M (m, 5, 5).

    They hold until the next exchange: most rows of a pass are not exchanged.
    """
    spread = per_sensor @ np.linalg.inv(M)
    return spread, np.einsum("mki,mki->mk", spread, per_sensor)


def optimal_positions(schedule: CalibrationSession, sigma: Array) -> OptimalPositions:
    """Positions of the same number as the schedule's that tell most.

    ``sigma`` (m,) is the noise of a reading at the input, m/s² (rad/s).

    Two starts: the rows of the schedule, and rows scattered by the golden ratio. Where neither ends above the
    schedule, the schedule itself is the answer.
    """
    assert schedule.beta is not None
    assert schedule.flipped is not None
    runs = np.unique(schedule.flipped)
    grid = 2 * np.pi * np.arange(GRID) / GRID
    beta = np.concatenate([schedule.beta, np.tile(grid, len(runs))])
    flipped = np.concatenate([schedule.flipped, np.repeat(runs, GRID)])
    candidates = whitened(schedule, beta, flipped, sigma)
    given = np.arange(len(schedule.beta))
    scattered = len(given) + np.floor((GOLDEN * np.arange(1, len(given) + 1) % 1.0) * len(runs) * GRID).astype(np.intp)
    best = max(
        (exchanged(start, candidates) for start in (given, scattered)), key=lambda r: log_information(candidates[r])
    )
    gain = log_information(candidates[best]) - log_information(candidates[given])
    order = best[np.lexsort((beta[best], flipped[best]))]
    places = {(round(float(beta[k]), 9), bool(flipped[k])) for k in order}
    efficiency = float(np.exp(-gain / (5 * len(schedule.sensors))))
    return OptimalPositions(beta[order], flipped[order], efficiency, len(places))
