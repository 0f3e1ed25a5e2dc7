"""The paper's search: adaptive coordinate descent on the triples functional, and Levenberg–Marquardt beside it.

Coordinate descent. One iteration is one pass over all parameters. Each is tried a step up and, if that does not lower
the functional, a step down; what lowers it is kept and the step grows, otherwise it shrinks. The paper states neither
the first step nor the factors; `GROW` and `SHRINK` are those with which its iteration counts are met.
Source: multi-parameter optimisation paper, text after equation (5), after Bunday's textbook.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from benchmarks.papers.triples import Triples
from estimator.parameters import SensorParameters
from estimator.session import Array

FIRST_STEP = 0.01
"""Dimensionless: 1 % of scale, 0.01 g, 0.01 rad, the size of the errors that are looked for."""

GROW = 2.0
"""Factor on a parameter's step where it lowered the functional; see above."""
SHRINK = 0.5
"""Factor on a parameter's step where neither side lowered it; see above."""

STILL = 1e-12
"""Steps below this are rounding."""

MOST_ITERATIONS = 20_000
"""Ten times what the worst set of orientations takes (docs/methods/optimisation.md)."""


@dataclass(frozen=True, eq=False)
class Search:
    """The end of a search on the triples functional, and its path."""

    x: Array
    """(P,) δk, b/g, α, β of `Triples`; relative, rad."""
    parameters: SensorParameters
    functional: float
    """(m/s²)²"""
    iterations: int
    """Passes over all parameters; for Levenberg–Marquardt, Jacobians."""
    evaluations: int
    """Evaluations of the functional."""
    converged: bool
    path: Array
    """(iterations, P) where each iteration ended, as `x`; only the last for Levenberg–Marquardt."""


def descend(
    problem: Triples,
    start: Array | None = None,
    *,
    below: float = 0.0,
    finest: float = STILL,
    most: int = MOST_ITERATIONS,
    step: float = FIRST_STEP,
    grow: float = GROW,
    shrink: float = SHRINK,
) -> Search:
    """Adaptive coordinate descent, as published.

    Parameters
    ----------
    start : (P,) dimensionless; the nominal values, all zero, unless given.
    below : functional, (m/s²)², at which to stop.
    finest : step at which to stop, when every parameter's is down to it; rounding unless given.
    most : iterations.
    step : of every parameter at first, dimensionless.
    grow, shrink : factors of a parameter's step after success and failure.
    """
    x = np.zeros(len(problem.free)) if start is None else np.array(start, dtype=float)
    steps = np.full(len(x), step)
    best, evaluations = problem.functional(x), 1
    path: list[Array] = []
    while len(path) < most and best > below and steps.max() > finest:
        for p in range(len(x)):
            here = x[p]
            for side in (1.0, -1.0):
                x[p] = here + side * steps[p]
                value = problem.functional(x)
                evaluations += 1
                if value < best:
                    best = value
                    break
            else:
                x[p] = here
                steps[p] *= shrink
                continue
            steps[p] *= grow
        path.append(x.copy())
    ended = best <= below or bool(steps.max() <= finest)
    return Search(x, problem.parameters(x), best, len(path), evaluations, ended, np.array(path).reshape(-1, len(x)))


def levenberg_marquardt(problem: Triples, start: Array | None = None) -> Search:
    """Minimises the functional by MINPACK's Levenberg–Marquardt with the exact Jacobian; start (P,) dimensionless."""
    x = np.zeros(len(problem.free)) if start is None else start
    solution = least_squares(problem.misses, x, jac=problem.jacobian, method="lm", xtol=1e-14, ftol=1e-14, gtol=1e-14)
    return Search(
        x=solution.x,
        parameters=problem.parameters(solution.x),
        functional=float(2 * solution.cost),
        iterations=int(solution.njev or solution.nfev),
        evaluations=int(solution.nfev),
        converged=bool(solution.success),
        path=solution.x[None],
    )
