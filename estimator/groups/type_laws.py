"""Learns the distribution of the temperature laws of a type's sensors from the histories of its units.

Each history is fitted by itself, at every scatter about its law. How often each scatter comes is the distribution that
makes all histories together most likely (Laird 1978, J. Am. Stat. Assoc. 73, 805), by expectation and maximisation,
with one history more that says nothing. Mean and spread of the coefficients are those of `random_effects`; the spread
of n sensors is known to n − 1 degrees of freedom, so that of one more is larger by the variance of Student's t.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.groups.random_effects import mean_of
from estimator.health.temperature_law import FOLLOW, LawHistory, Seen, history_of
from estimator.health.type_law import SCATTERS, TypeLaw, chances, columns_about, fit_at_every_scatter
from estimator.health.warmth import WARMED, shown_columns
from estimator.results import Calibration
from estimator.session import Array

FEWEST_UNITS = 5
"""Fewest units with histories for a law of their type."""
FEWEST_SENSORS = 10
"""Fewest sensors for a law of their type: the spread over fewer is hardly known."""
ROUNDS = 200
"""Rounds of expectation and maximisation; the chances of scatters no longer move by then."""


@dataclass(frozen=True, eq=False)
class UnitHistory:
    """The sessions of one unit since one reference."""

    reference: Calibration
    sessions: Sequence[Seen]
    """The reference among them, in order of time."""


def type_laws(units: Sequence[UnitHistory], tolerances: Mapping[tuple[str, str], float]) -> tuple[TypeLaw, ...]:
    """The laws of every kind of sensor and parameter with enough units.

    Parameters
    ----------
    units : one history each.
    tolerances : T by kind of sensor and parameter, relative for scale, else SI.
    """
    laws = (
        _law(units, (kind, parameter), tolerance)
        for (kind, parameter), tolerance in tolerances.items()
        if parameter in FOLLOW
    )
    return tuple(law for law in laws if law is not None)


def _law(units: Sequence[UnitHistory], place: tuple[str, str], tolerance: float) -> TypeLaw | None:
    by_unit = [found for unit in units if (found := tuple(_histories(unit, *place, tolerance)))]
    histories = [history for found in by_unit for history in found]
    if len(by_unit) < FEWEST_UNITS or len(histories) < FEWEST_SENSORS:
        return None
    about = float(np.mean([history.celsius.mean() for history in histories]))
    scatter, size, variance = _fitted(histories, about)
    pairs = [_mean_and_spread(size[:, q], variance[:, q]) for q in range(2)]
    mean, sigma = zip(*pairs, strict=True)
    return TypeLaw(*place, tolerance, about, mean, sigma, tuple(scatter.tolist()), len(histories), len(by_unit))


def _histories(unit: UnitHistory, kind: str, parameter: str, tolerance: float) -> Iterator[LawHistory]:
    """The histories of the unit's sensors of a kind, where its sessions show a bend apart from level and line."""
    for sensor in unit.reference.sensors:
        history = history_of(unit.sessions, sensor, parameter, tolerance) if sensor.kind == kind else None
        if history is not None and history.celsius.std() >= WARMED and shown_columns(history.celsius).shape[1] > 1:
            yield history


def _fitted(histories: Sequence[LawHistory], about: float) -> tuple[Array, Array, Array]:
    """(K,) chances of scatters, and (n, 2) coefficients of every history, T per °C and °C², with their variances."""
    fits = [fit_at_every_scatter(history.readings, columns_about(history.celsius, about)) for history in histories]
    logs = np.stack([log_likelihood for *_, log_likelihood in fits])
    nothing = np.full(len(SCATTERS), 1 / len(SCATTERS))
    prior = nothing
    for _ in range(ROUNDS):
        prior = (chances(logs, prior).sum(axis=0) + nothing) / (len(fits) + 1)
    share = chances(logs, prior)
    law_sizes = np.stack([size[:, -2:] for size, *_ in fits])
    variance = np.stack([np.diagonal(covariance, axis1=-2, axis2=-1)[:, -2:] for _, covariance, _ in fits])
    size = np.einsum("nk,nkq->nq", share, law_sizes)
    return prior, size, np.einsum("nk,nkq->nq", share, variance + (law_sizes - size[:, None]) ** 2)


def _mean_and_spread(value: Array, variance: Array) -> tuple[float, float]:
    """Mean of values (n,) with variances (n,), and one sigma of one more value."""
    n = len(value)
    found = mean_of((value / variance)[:, None], (1 / variance)[:, None, None])
    return float(found.value[0]), float(np.sqrt(found.spread**2 * (n - 1) / (n - 3) + found.sigma[0] ** 2))
