"""How much longer a record must be before it can tell."""

import numpy as np
from scipy.linalg import solve_triangular

from estimator.readiness.course import Course
from estimator.session import Array

GROWTH = 1.2 ** np.arange(1, 26)
"""Lengths that are tried, in lengths of the record: steps of a fifth, to a hundred times."""
LONGEST = 8 * 3600.0
"""s of record, a working day, beyond which no length is proposed."""
MARGIN = 2.5
"""Standard errors of the forecast that must fit into what is allowed: 1.64 for the bound of 95 %, and the forecast
itself, which is not zero, is rarely more than one of its standard errors off."""
CELLS = 5
"""Likeliest cells, whose median length is told."""


def needed(course: Course, means: int, duration: float, allowed: float) -> float | None:
    """s more until the forecast over ``duration`` s is good to ``allowed``, m/s² or rad/s; None where none will do.

    Foreseen for as many ``means`` as now, each over more samples.
    """
    cells = np.argsort(course.weight)[-CELLS:]
    lengths = np.array([_enough(course, int(cell), means, duration, allowed) for cell in cells])
    order = np.argsort(lengths)
    share = np.cumsum(course.weight[cells][order])
    found = float(lengths[order][np.searchsorted(share, share[-1] / 2)])
    return found if np.isfinite(found) else None


def _enough(course: Course, cell: int, means: int, duration: float, allowed: float) -> float:
    """s more under one cell; infinite where none will do."""
    for growth in GROWTH[GROWTH * course.span <= LONGEST]:
        if MARGIN * np.sqrt(_variance(course, cell, means, float(growth), duration)) <= allowed:
            return float((growth - 1) * course.span)
    return np.inf


def wander(course: Course, duration: float) -> float:
    """One sigma of the walk over ``duration`` s, m/s² or rad/s."""
    variance = course.scatter / max(course.freedom - 2, 1) * course.walk * duration / course.span
    return float(np.sqrt(course.weight @ variance))


def _variance(course: Course, cell: int, means: int, growth: float, duration: float) -> float:
    """Of the forecast, (m/s²)² or (rad/s)², by a record ``growth`` times as long."""
    span, tau, walk = growth * course.span, course.tau[cell], course.walk[cell] * growth**2
    sigma2 = course.scatter[cell] / course.freedom / growth
    x = (np.arange(means) + 0.5) / means
    L = np.linalg.cholesky(np.eye(means) + walk * np.minimum.outer(x, x))
    settles = -np.expm1(-np.outer(x, span / tau))
    white = solve_triangular(L, np.column_stack([np.ones(means), x, settles]), lower=True)
    h: Array = np.array([0.0, duration / span, *(np.exp(-span / tau) * -np.expm1(-duration / tau))])
    known = np.linalg.lstsq(white.T @ white + 1e-9 * np.eye(4), h, rcond=None)[0]
    return float(sigma2 * (h @ known + walk * duration / span))
