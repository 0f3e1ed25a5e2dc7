"""Other ways to notice that a parameter moved, on whole histories; each gives a figure that grows with suspicion.

The optimum knows what no workshop knows: the kinds of change of the generator, their sizes and their shares. Neyman and
Pearson's lemma says that no rule finds more of that mixture at the same rate of false alarms; of one kind alone, no
rule finds more than the likelihood ratio of that kind.
"""

from collections.abc import Callable, Sequence

import numpy as np
import ruptures

from benchmarks.backtest.histories import STEP, History
from estimator.session import Array

LAMBDA = 0.3
SLACK = 0.5
EVENTS = ("ramp", "step", "aging", "walk")


def log_ratios(history: History) -> dict[str, float]:
    """Log likelihood ratio of each of the generator's own changes to nothing, whatever the level: over a grid of sizes
    of 0.03 T and less, of every day that a truth has, of nine constants and of seven strengths of a walk."""
    level, value = np.ones((len(history.time), 1)), history.value[:, None]
    noise = np.diag(history.sigma**2)
    still = _flat(value, noise, level)[0]
    ratios = {}
    for kind in EVENTS[:-1]:
        courses = _shapes(kind, history.time)
        ratios[kind] = float(np.logaddexp.reduce(_flat(value - courses, noise, level) - still)) - np.log(
            courses.shape[1]
        )
    wandering = np.minimum.outer(history.time, history.time)
    walks = [_flat(value, noise + q**2 * wandering, level)[0] - still for q in np.linspace(0.1, 0.4, 7)]
    ratios["walk"] = float(np.logaddexp.reduce(walks)) - np.log(len(walks))
    return ratios


def optimum(history: History) -> float:
    """Log likelihood ratio of all of them in equal shares."""
    return float(np.logaddexp.reduce(list(log_ratios(history).values())))


def _shapes(kind: str, time: Array) -> Array:
    """(n, many) every course of a kind, on a grid; T."""
    signed = np.array([-1.0, 1.0])
    if kind == "ramp":
        return time[:, None] * np.outer(np.linspace(0.2, 0.8, 25), signed).ravel()
    if kind == "aging":
        rise = [-np.expm1(-time / years) for years in np.linspace(0.3, 1.5, 9)]
        size = np.outer(np.linspace(0.5, 1.2, 25), signed).ravel()
        return np.concatenate([r[:, None] * size for r in rise], axis=1)
    onsets = np.arange(STEP / 2, time[-2], STEP)
    jumps, size = (time[:, None] >= onsets).astype(float), np.outer(np.linspace(0.4, 1.2, 25), signed).ravel()
    return (jumps[:, :, None] * size).reshape(len(time), -1)


def _flat(values: Array, covariance: Array, level: Array) -> Array:
    """(many,) log likelihood of columns of readings with an unknown level."""
    inverse = np.linalg.inv(covariance)
    precision = level.T @ inverse @ level
    rest = values - level @ np.linalg.solve(precision, level.T @ inverse @ values)
    logdet = np.linalg.slogdet(covariance)[1] + np.linalg.slogdet(precision)[1]
    return np.asarray(-0.5 * (np.einsum("nm,nk,km->m", rest, inverse, rest) + logdet))


def fixed(history: History) -> float:
    """Largest |change since the reference|, in tolerances."""
    return float(np.abs(history.value).max())


def ewma(history: History) -> float:
    """Largest |exponentially weighted mean| of the changes in sigmas."""
    mean, found = 0.0, 0.0
    for x in history.value / history.sigma:
        mean = (1 - LAMBDA) * mean + LAMBDA * x
        found = max(found, abs(mean))
    return found


def cusum(history: History) -> float:
    """Largest of both cumulative sums of the changes in sigmas, less the slack (Page 1954)."""
    up = down = found = 0.0
    for x in history.value / history.sigma:
        up, down = max(0.0, up + x - SLACK), max(0.0, down - x - SLACK)
        found = max(found, up, down)
    return found


def change_point(history: History) -> float:
    """Cost saved by one change of the mean, placed by `ruptures` (dynamic programming, squared error)."""
    x = (history.value / history.sigma)[:, None]
    search = ruptures.Dynp(model="l2", min_size=1, jump=1).fit(x)
    place = search.predict(n_bkps=1)[0]
    return float(search.cost.error(0, len(x)) - sum(search.cost.error(*ends) for ends in ((0, place), (place, len(x)))))


Rule = Callable[[History], float]
RIVALS: dict[str, Rule] = {
    "fixed share of the tolerance": fixed,
    "EWMA, λ = 0.3": ewma,
    "CUSUM, slack 0.5 σ": cusum,
    "one change of the mean, ruptures": change_point,
}


def figures(rule: Rule, made: Sequence[History]) -> Array:
    """(M,) figures of a rule."""
    return np.array([rule(one) for one in made])
