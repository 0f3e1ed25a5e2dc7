"""Separation of a hidden effect from every rival: what the best fit of the rival and the baseline leaves of it."""

from dataclasses import dataclass

import numpy as np

from tests.blind.catalogue import CATALOGUE
from tests.blind.rivals import Candidate, candidates
from tests.blind.strength import Lens
from tests.blind.world import Array, Effect

DUST = 1e-5
"""A signature of which the baseline leaves less than this share is not seen at all."""
CONTAINS = 2.0
"""A rival with more parameters that leaves less than this merely contains the simpler cause."""


SAME_SPAN = frozenset({"g-sensitivity", "sensor-drift"})
"""Causes that on one stand at one setting are alike: k·n of a gyro is a change of its scale and axis, whatever
parsimony counts.
"""


@dataclass(frozen=True)
class Rival:
    """One explanation and its distance from the truth."""

    cause: str
    sensors: tuple[int, ...]
    left: float
    """Standard errors of a reading."""


class Field:
    """All explanations of one session seen through one lens."""

    def __init__(self, lens: Lens, between: bool):
        self.lens = lens
        self._seen = [(c, *_through(lens, c)) for c in candidates(lens.session, between)]

    def rivals(self, left: Array, cause: str, sensors: tuple[int, ...], own: int | None) -> list[Rival]:
        """Every other explanation of a truth of which ``left`` (n,), standard errors, is left, nearest first.

        ``own`` counts the truth's parameters for parsimony; None when the truth is no cause of the catalogue.
        """
        found = []
        for candidate, columns, visible in self._seen:
            if candidate.name == (cause, sensors) or not len(columns):
                continue
            norm = best_fit(columns, visible, left, candidate.fixed)
            if own is None or norm >= CONTAINS or not simpler(own, cause, candidate):
                found.append(Rival(candidate.cause, candidate.sensors, norm))
        return sorted(found, key=lambda rival: rival.left)

    def nearest_to_noise(self, effect: Effect, left: Array) -> Rival:
        """The mean effect that explains most of added noise as it was drawn, ``left`` (n,) in standard errors.

        It is as far off as the evidence it lacks.
        """
        evidence = self.lens.noise_evidence(effect.sensor, effect.k, left)
        nearest = self.rivals(left, effect.cause, effect.sensors, None)[0]
        explained = left @ left - nearest.left**2
        return Rival(nearest.cause, nearest.sensors, float(np.sqrt(max(0.0, evidence - explained))))


def simpler(own: int, cause: str, candidate: Candidate) -> bool:
    """Whether parsimony prefers the truth to a candidate that contains it."""
    return CATALOGUE[candidate.cause].parameters > own and {cause, candidate.cause} != SAME_SPAN


def _through(lens: Lens, candidate: Candidate) -> tuple[Array, Array]:
    """(G, N, p) left columns of unit length where free, and which are visible at all."""
    G, n, p = candidate.columns.shape
    flat = candidate.columns.transpose(1, 0, 2).reshape(n, G * p)
    white, left = np.linalg.norm(lens.whiten(flat), axis=0), lens.left(flat)
    size = np.linalg.norm(left, axis=0)
    visible = size > DUST * white
    scale = np.where(visible & (not candidate.fixed), np.where(size > 0, size, 1.0), 1.0)
    left = np.where(visible, left / scale, 0.0)
    return left.reshape(-1, G, p).transpose(1, 0, 2), visible.reshape(G, p)


def best_fit(columns: Array, visible: Array, left: Array, fixed: bool) -> float:
    """Norm that the best of G shapes leaves of ``left`` (n,), standard errors: columns (G, n, p), visible (G, p)."""
    if fixed:
        squared = np.sum(columns[..., 0] ** 2, axis=1) - 2 * columns[..., 0] @ left + left @ left
        return float(np.sqrt(max(squared.min(), 0.0)))
    gram = np.einsum("gnp,gnq->gpq", columns, columns)
    moment = columns.transpose(0, 2, 1) @ left
    explained = np.einsum("gp,gpq,gq->g", moment, np.linalg.pinv(gram, rcond=1e-8, hermitian=True), moment)
    return float(np.sqrt(max(left @ left - explained.max(), 0.0)))
