"""Lack of fit: a name claims that the cause fits, not that it is nearest.

What names leave on their sensor, or in common, is looked at as anything is looked at: for patterns, for smooth courses,
for scatter that is no noise. Where it holds structure that is no small part of what the names explain, they go.
"""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.selection.excess_noise import with_autocorrelation
from estimator.diagnosis.selection.forward import with_structures
from estimator.diagnosis.selection.ranking import extended_basis
from estimator.diagnosis.selection.search_state import LEVEL, Detection, SearchState
from estimator.diagnosis.signatures.noise import ExcessVariance, UnlikeNoise
from estimator.diagnosis.signatures.switching import switching
from estimator.on_demand import function_on_demand

if TYPE_CHECKING:
    from scipy.stats import shapiro
else:
    shapiro = function_on_demand("scipy.stats", "shapiro")

MISFIT = 0.05
"""Share of the energy of names that structure beside them may hold: beyond a fifth in rms it is another effect that
they are the nearest to, below it a cause described nearly, with something small beside it."""

DEPARTURE = 1.0
"""Share of the energy of names that structure may hold beside a sensor that follows a shared course: it may depart from
the course by as much as it follows it. Without its share of the course in the model it would pull what all sensors
share of a row.
"""

DOUBTFUL = 0.02
"""p-value of normal noise below which scatter in excess is called none: one true excess in fifty loses its name."""

UNUSUAL = 4.0
"""Variance over the stated one from which on excess noise may as well be an effect, from row to row, that no cause
explains: few people misjudge a noise by more than twice."""

OUTSIDER = 36.0
"""Variance over that of the others of its kind beyond which a sensor hides something: six times as noisy."""

FEWEST = 8
"""Rows from which on a distribution is judged."""

KNOWN = 0.5
"""Degrees of freedom that a row must have for its residual to show how noise is distributed."""


def without_misfits(state: SearchState) -> SearchState:
    """The state without names beside which structure is left that they should have explained."""
    for place, shared in dict.fromkeys((f.best.sensors, bool(f.event)) for f in state.detections):
        names = tuple(f for f in state.detections if f.best.sensors == place and bool(f.event) == shared)
        drifted = any(f.best.cause.moves_parameters for f in names)
        energy = remaining_energy(state, place) - (changed(state, place) if drifted else 0.0)
        if energy > (DEPARTURE if shared else MISFIT) * explained(state, names):
            rest = replace(state, detections=tuple(f for f in state.detections if f not in names))
            again = with_autocorrelation(with_structures(replace(rest, structures=elsewhere(rest, place))))
            state = again if remaining_energy(again, place) > 0 else rest
    return state


def without_common_rows(state: SearchState) -> SearchState:
    """The state without causes of single rows that most sensors show: something befell the rows, not the sensors."""
    single = tuple(f for f in state.detections if f.best.cause.passing and f.best.sensors and not f.event)
    if 2 * len({f.best.sensors for f in single}) <= max(state.sensor_count, 4):
        return state
    detections = tuple(f for f in state.detections if f not in single)
    return replace(state, detections=detections, structures=(*state.structures, *single))


def elsewhere(state: SearchState, place: tuple[int, ...]) -> tuple[Detection, ...]:
    """Structures of other places."""
    return tuple(s for s in state.structures if s.best.sensors != place)


def remaining_energy(state: SearchState, place: tuple[int, ...]) -> float:
    """χ² of structure without a name on a sensor, or in common."""
    patterns = sum(s.best.statistic for s in state.structures if s.best.sensors == place)
    return patterns + sum(a.strength**2 for a in state.autocorrelated if (a.sensor,) == place and a.plain)


def changed(state: SearchState, place: tuple[int, ...]) -> float:
    """χ² of a change of a sensor's parameters since the history that has no name: beside its drift it is more of it."""
    return sum(s.best.statistic for s in state.structures if s.best.sensors == place and s.best.cause.between)


def explained(state: SearchState, names: tuple[Detection, ...]) -> float:
    """χ² that some names explain together, given all that was found beside them."""
    others = replace(
        state,
        detections=tuple(f for f in state.detections if f not in names),
        structures=(),
    ).attributed()
    basis = extended_basis(others, np.concatenate([f.best.trace for f in names], axis=1))[:, others.shape[1] :]
    return float(((basis.T @ state.residuals.z) ** 2).sum())


def with_unlike_noise(state: SearchState) -> SearchState:
    """Sensors whose scatter, larger than stated or of unstated size, is not distributed as noise: no excess noise."""
    excess, unlike = {e.sensor: e for e in state.excess}, list(state.unlike_noise)
    for i in np.flatnonzero(state.baseline.unstated).tolist():
        noise = unlike_noise(state, i, excess.get(i))
        if noise is not None:
            unlike.append(noise)
        if noise is not None and noise.of_its_kind:
            excess.pop(i, None)
        elif noise is None and i in excess:
            excess[i] = replace(excess[i], doubtful=excess[i].ratio > UNUSUAL)
    coursing = {s.best.sensors for s in state.structures} | {(a.sensor,) for a in state.autocorrelated if a.plain}
    noisy = tuple(e for e in excess.values() if (e.sensor,) not in coursing)
    return replace(state, excess=noisy, unlike_noise=tuple(unlike))


def unlike_noise(state: SearchState, sensor: int, excess: ExcessVariance | None) -> UnlikeNoise | None:
    """The difference between a sensor's scatter and noise; None where there is none, or where too few rows tell."""
    residuals, attributed = state.residuals, state.attributed()
    freedom = residuals.row_freedom - (attributed[: residuals.rows] ** 2).sum(axis=1)
    of_sensor = (residuals.sensor_of_row[: residuals.rows] == sensor) & (freedom > KNOWN)
    if of_sensor.sum() < FEWEST:
        return None
    y = state.remaining[: residuals.rows][of_sensor] / np.sqrt(freedom[of_sensor])
    variance = float(np.mean(y**2))
    if unlike_its_kind(state.baseline, sensor, variance):
        return UnlikeNoise(sensor, 0.0, variance, of_its_kind=False)
    noise = 0.0 if excess is None else float(np.median(state.stated[:, sensor] / state.baseline.variance[:, sensor]))
    switches = float(np.exp(-max(switching(residuals, attributed, sensor, noise), 0.0)))
    p_value = min(1.0, 2 * min(float(shapiro(y).pvalue), switches))
    if p_value >= (LEVEL / state.sensor_count if excess is None else DOUBTFUL):
        return None
    return UnlikeNoise(sensor, p_value, float(np.abs(y).max() / np.sqrt(variance)), switches=2 * switches <= p_value)


def unlike_its_kind(baseline: Baseline, sensor: int, variance: float) -> bool:
    """Whether a sensor of no stated noise scatters far beyond the others of its kind; ``variance`` of its residual."""
    usual = 0.0 if baseline.expected_ratio is None else float(baseline.expected_ratio[sensor])
    return usual > 0 and variance > OUTSIDER * usual
