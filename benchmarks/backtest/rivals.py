"""Other ways to notice that a parameter moved, on whole histories; each gives a figure that grows with suspicion.

The optimum knows what no workshop knows: the kinds of change of the generator, their sizes and their shares. Neyman and
Pearson's lemma says that no rule finds more of that mixture at the same rate of false alarms.
"""

from collections.abc import Callable, Sequence

import numpy as np
import ruptures

from benchmarks.backtest.histories import STEP, History
from estimator.session import Array

LAMBDA = 0.3
SLACK = 0.5
EVENTS = ("ramp", "step", "aging", "walk")


def optimum(history: History) -> float:
    """Log likelihood ratio of the generator's own changes, in equal shares, to nothing."""
    level = np.ones((len(history.time), 1))
    shapes = {kind: _shapes(kind, history.time) for kind in EVENTS if kind != "walk"}
    noise = np.diag(history.sigma**2)
    still = _flat(history.value[:, None], noise, level)[0]
    ratios = [np.logaddexp.reduce(_flat(history.value[:, None] - f, noise, level) - still) - np.log(f.shape[1])
              for f in shapes.values()]  # fmt: skip
    walks = np.linspace(0.1, 0.4, 7)
    walked = [_flat(history.value[:, None], noise + q**2 * np.minimum.outer(history.time, history.time), level)[0]
              for q in walks]  # fmt: skip
    ratios.append(np.logaddexp.reduce(np.array(walked) - still) - np.log(len(walks)))
    return float(np.logaddexp.reduce(ratios))


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
    """What one change of the mean, placed by `ruptures` (dynamic programming, squared error), takes off the cost."""
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
