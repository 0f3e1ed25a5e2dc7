"""Ways of taking one history for a forecast: with jumps or as a walk, with temperature acting or not."""

import numpy as np

from estimator.health.detection import Detected, Warmth, centred
from estimator.health.fits import PART_KINDS, PART_SIZES, Readings
from estimator.health.pooled import Prior
from estimator.health.posterior import Draws
from estimator.health.shapes import Kind
from estimator.session import Array

UNLIKELY = 30.0
"""Log odds against what is ruled out."""


def ways(detected: Detected, prior: Prior) -> list[tuple[Readings, float]]:
    """The readings as they are, and with the jumps that are over acting, each with the log of what speaks for it.

    A walk shows jumps too, and what is left between them would be taken for a drift. Jumps act with any size a in the
    likelihood; beside it speaks the rate of jumps in their gaps, and Π exp(−a²/2s²)/s over the components.
    """
    if not detected.over:
        return [(detected.readings, 0.0)]
    time, own, log = detected.readings.time, PART_KINDS == Kind.JUMP, 0.0
    size = PART_SIZES[own]
    for change in detected.over:
        likely = -(change.size**2).sum() / (2 * size**2) - len(change.size) * np.log(size)
        expected = prior.rate[own] * (time[change.gap] - time[change.gap - 1])
        log += float(np.logaddexp.reduce(np.log(np.maximum(expected, 1e-300)) + likely))
    return [(detected.readings, 0.0), (detected.without_jumps(), log)]


def felt(warmth: Warmth | None, temperature: Array) -> Array:
    """(n,) °C about their mean at the sessions; zero where the temperature was found and acts whatever else does."""
    return np.zeros(len(temperature)) if warmth is not None and warmth.is_found else centred(temperature)


def swing(warmth: Warmth | None, draws: Draws, temperature: Array) -> Array:
    """(N, 1) T that the span of temperatures (n,) °C takes off the tolerance of every draw, on either side."""
    away = np.abs(centred(temperature)).max()
    if warmth is not None and warmth.is_found:
        return np.full((len(draws.weight), 1), np.linalg.norm(warmth.coefficient) * away)
    return np.asarray(np.linalg.norm(draws.slope, axis=1, keepdims=True) * away)


def where_found(logs: Array, warmth: Warmth | None) -> Array:
    """(Q, P) log evidence of a history in which the temperature, if it was found, acts whatever else does: nothing else
    is then temperature alone, of each size by how likely the coefficient is under its law."""
    if warmth is None or not warmth.is_found:
        return logs
    own, logs = PART_KINDS == Kind.WARMTH, logs.copy()
    spread = PART_SIZES[own, None] ** 2 + warmth.sigma**2
    alike = -0.5 * (np.log(spread) + warmth.coefficient**2 / spread).sum(axis=1)
    logs[:, own] = logs[:, :1] + alike - alike.max()
    logs[:, 0] -= UNLIKELY
    return logs
