"""Decides whether the quadratic terms are estimated, and which of several minima is taken.

χ² of unknown orientations has more than one minimum once the quadratic terms are free: with few orientations they trade
against scale and bias along a valley. Every minimum is therefore looked for from several points: where the search came
from, and some standard errors up and down the least known directions.

Terms are plainly there when leaving them out costs more χ² than chance allows, each model at its own best minimum under
the same noise: a likelihood ratio, χ² of q terms where the noise is stated, Fisher's F where it is estimated from ν
degrees of freedom. That the terms are many of their standard errors from zero (Wald) proves nothing at a far minimum.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from estimator.calibration.free.excess import explained
from estimator.calibration.free.information import information
from estimator.calibration.free.model import ModelRows, Unknowns, linearise
from estimator.calibration.free.noise import scaled, search_with_noise
from estimator.calibration.free.solve import Solution, search
from estimator.calibration.free.start import starts
from estimator.coverage import WANTED
from estimator.significance import p_value

Run = Callable[[ModelRows, Unknowns, bool], Solution]

USEFUL_QUADRATIC = 1e-4
"""Sigma of c·g below which the quadratic term is worth estimating, be it there or not: 100 µg at 1 g. On measured
recordings such terms improve what is predicted of positions held out (docs/recordings.md)."""

PLAIN_QUADRATIC = 1e-3
"""Probability, without any quadratic term, of a likelihood ratio this large: below it the term is there. One set in a
thousand gets a term that it does not need."""

FAR = 3.0
"""Standard errors to either side of a minimum from which another is looked for: the edge of where the search began."""

VALLEYS = 2
"""Least known directions that are followed: the quadratic terms trade with the scales along one, with the biases along
the other."""

STRAIGHT = 0.01
"""Dimensionless; a shorter way stays where the model is straight to a per cent, and leads back to the same minimum."""

LOWER = 1e-3
"""Fall of χ² from which another minimum is a lower one: far below what any choice rests on."""

PARABOLA = 2.0
"""Times the fall of χ² up to which the square of the terms in standard errors agrees with it: they are equal where χ²
is a parabola, and beyond twice that it is not one."""


def solve(rows: ModelRows, stated: bool, quadratic: bool | None) -> Solution:
    """The search, with or without the quadratic term (None: if it deserves it), with or without stated noise."""
    plain, *extended = candidates(rows, stated, quadratic)
    return extended[0] if extended and is_supported(extended[0], plain, stated) else plain


def candidates(rows: ModelRows, stated: bool, quadratic: bool | None) -> list[Solution]:
    """The search without the quadratic term, and, where that is to be decided and can be afforded, with it."""
    run: Run = search if stated else search_with_noise
    first, *others = starts(rows)
    plain = lowest(run, run(rows, first, bool(quadratic)), others)
    if quadratic is not None or not affordable(plain, stated):
        return [plain]
    return [plain, lowest(run, run(plain.rows if stated else rows, plain.unknowns, True), [])]


def agreed(rows: ModelRows, judged: Callable[[Solution], bool]) -> bool:
    """The verdict of ``judged`` on the solution that `solve` would give under stated noise. Where it is the same with
    the quadratic terms and without, the choice between the two is not made.
    """
    plain, *extended = candidates(rows, True, None)
    of_plain = judged(plain)
    if not extended or judged(extended[0]) == of_plain:
        return of_plain
    return is_supported(extended[0], plain, True) != of_plain


def affordable(plain: Solution, stated: bool) -> bool:
    """Whether the terms would be determined and leave enough degrees of freedom: one, or enough to estimate the
    noise.
    """
    wanted = information(plain.rows, plain.unknowns, quadratic=True)
    remaining_dof = plain.dof + plain.knowledge.rank - wanted.rank
    return wanted.full and remaining_dof >= (1 if stated else WANTED)


def lowest(run: Run, solution: Solution, others: list[Unknowns]) -> Solution:
    """The lowest of the minima around ``solution`` and from other starts, all compared under its noise."""
    best = solution
    for start in (*others, *starts_around(solution)):
        tried = search(solution.rows, start, solution.quadratic)
        if tried.converged and tried.chi2 < best.chi2 - LOWER:
            best = tried
    return solution if best is solution else run(solution.rows, best.unknowns, solution.quadratic)


def starts_around(solution: Solution) -> list[Unknowns]:
    """Points `FAR` standard errors up and down the least known directions, each orientation turned to suit; none where
    the search has not ended, since standard errors mean nothing there."""
    if not solution.converged:
        return []
    order = np.argsort(solution.knowledge.variances)
    steps = [s for s in FAR * scaled(solution.knowledge)[:, order[-VALLEYS:]].T if np.linalg.norm(s) > STRAIGHT]
    if not steps:
        return []
    linear = linearise(solution.rows, solution.unknowns)
    return [solution.unknowns.stepped(s, linear.turns(s)) for step in steps for s in (step, -step)]


def without_terms(unknowns: Unknowns) -> Unknowns:
    """The unknowns without quadratic terms."""
    return replace(unknowns, quadratic=np.zeros_like(unknowns.quadratic))


def is_supported(extended: Solution, plain: Solution, stated: bool) -> bool:
    """Whether the quadratic terms are significant, or well known at their own minimum."""
    used = explained(extended) if stated else extended
    if not used.knowledge.full or not used.converged:
        return False
    without = lowest(search, search(used.rows, plain.unknowns, False), [without_terms(used.unknowns)])
    fall = max(without.chi2 - used.chi2, 0.0)
    q, terms = used.knowledge.rank - without.knowledge.rank, np.arange(2, len(used.knowledge.covariance), 5)
    if p_value(fall, q, used.freedom) < PLAIN_QUADRATIC:
        return True
    covariance, c = used.knowledge.covariance[np.ix_(terms, terms)], used.unknowns.quadratic
    near = bool(c @ np.linalg.solve(covariance, c) < PARABOLA * fall + 1.0)
    return near and bool(np.all(np.diagonal(covariance) < USEFUL_QUADRATIC**2))
