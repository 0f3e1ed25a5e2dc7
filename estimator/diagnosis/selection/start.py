"""A search with nothing found yet: the residuals of a session and the traces of every cause in them."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from estimator.causes.contract import Cause, Signature
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.between_sessions import parameter_change
from estimator.diagnosis.residuals.refitted import refitted
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.selection.search_state import NEW_DIRECTION, SearchState
from estimator.diagnosis.signatures.lasting import traces_of
from estimator.diagnosis.signatures.noise import Autocorrelation, ExcessVariance
from estimator.diagnosis.signatures.patterns import PATTERNS
from estimator.diagnosis.signatures.traces import INVISIBLE, Traces
from estimator.least_squares import orthonormal
from estimator.session import Array

ROUNDS = 20
"""Steps of a sensor's variance: each brings it half nearer at least."""

CLOSE = 0.01
"""Relative change of a variance below which it has settled: hundreds of readings tell it to some per cent."""


def begin(
    baseline: Baseline,
    history: Sequence[Baseline],
    catalogue: Sequence[Cause],
    patterns: Sequence[Signature] = PATTERNS,
) -> SearchState:
    """The search for causes of a catalogue in a fitted session; ``history`` in the frame of the session. ``patterns``
    are looked for besides; none where nothing is searched for."""
    baseline = since(baseline, history)
    residuals = WhitenedResiduals.of(baseline, parameter_change(baseline, history))
    signatures = [c for c in catalogue if isinstance(c, Signature)]
    return SearchState(
        tuple(history),
        tuple(catalogue),
        residuals,
        tuple(traces_of(residuals, signatures)),
        tuple(pattern_traces(residuals, patterns)),
        baseline.variance,
    )


def pattern_traces(residuals: WhitenedResiduals, patterns: Sequence[Signature]) -> Iterator[Traces]:
    """The traces of structure without a name.

    Whether a sensor changed since the history is asked in stated noise only: one that is estimated from what is left
    would be smaller for two structures than for the one cause that they stand in for.
    """
    stated = ~residuals.baseline.unstated
    for traces in traces_of(residuals, patterns):
        every = range(len(traces.shapes))
        chosen = [k for k in every if stated[traces.sensor[k]]] if traces.cause.between else every
        if chosen:
            yield traces if len(chosen) == len(every) else traces.chosen(list(chosen))


def since(baseline: Baseline, history: Sequence[Baseline]) -> Baseline:
    """The baseline, which knows how the block sits turned since the latest of its history, where that can show."""
    alike = [h for h in history if h.setting.kinds == baseline.setting.kinds]
    turn = alike[-1].turn if alike and not baseline.gauge_free.any() else np.zeros(3)
    return replace(baseline, setting=replace(baseline.setting, turn=turn))


def restart_with_known_noise(state: SearchState, scatter: Sequence[ExcessVariance | Autocorrelation]) -> SearchState:
    """The search begun anew with one sensor's variance as it is, known from its own residuals alone."""
    sensors = [entry.sensor for entry in scatter]
    unstated = state.baseline.unstated.copy()
    unstated[sensors] = True
    known = with_residual_scatter(replace(state.baseline, unstated=unstated), [[i] for i in sensors])
    ratio = np.median(known.variance / state.baseline.variance, axis=0)
    scaled = [entry if entry.ratio == 1 else replace(entry, ratio=float(ratio[entry.sensor])) for entry in scatter]
    excess = (*state.excess, *(s for s in scaled if isinstance(s, ExcessVariance)))
    autocorrelated = (*state.autocorrelated, *(s for s in scaled if isinstance(s, Autocorrelation)))
    begun = restart_from(with_earlier_scatter(state, sensors), refitted(known))
    return replace(begun, excess=excess, autocorrelated=autocorrelated)


def with_earlier_scatter(state: SearchState, sensors: Sequence[int]) -> SearchState:
    """The state whose earlier sessions state nothing of the noise of some sensors either: their residuals tell it."""
    kinds = state.baseline.setting.kinds
    each = [[i] for i in sensors]
    history = (refitted(with_residual_scatter(h, each)) if h.setting.kinds == kinds else h for h in state.history)
    return replace(state, history=tuple(history))


def with_residual_scatter(baseline: Baseline, groups: Sequence[Sequence[int]], named: Array | None = None) -> Baseline:
    """The baseline with the variance of some sensors that of their own residuals (restricted likelihood).

    Sensors of one group are off by one factor. ``named`` (R, m, q) are effects, any unit, that count as no noise. Step
    by step: a sensor that is believed too much pulls what all share of a row to its own readings.
    """
    variance = baseline.variance.copy()
    for _ in range(ROUNDS):
        energy, freedom = remaining_of_sensors(WhitenedResiduals.of(replace(baseline, variance=variance)), named)
        larger = np.array([energy[list(g)].sum() / max(freedom[list(g)].sum(), 1.0) for g in groups])
        for group, factor in zip(groups, larger, strict=True):
            variance[:, list(group)] *= factor
        if np.abs(np.log(larger)).max() < CLOSE:
            break
    return replace(baseline, variance=variance)


def remaining_of_sensors(residuals: WhitenedResiduals, named: Array | None) -> tuple[Array, Array]:
    """(m,) energy, dimensionless, and (m,) degrees of freedom of what effects (R, m, q) leave of each sensor."""
    z, freedom = left_by(residuals, named)
    of_sensor = residuals.sensor_of_row[: residuals.rows] == np.arange(len(residuals.baseline.unstated))[:, None]
    return of_sensor @ z**2, of_sensor @ freedom


def left_by(residuals: WhitenedResiduals, named: Array | None) -> tuple[Array, Array]:
    """(N,) standard errors, the session's rows beside effects (R, m, q), any unit, and (N,) their degrees of freedom;
    beside nothing where None."""
    z, freedom = residuals.z[: residuals.rows], residuals.row_freedom
    if named is None:
        return z, freedom
    trace, raw = residuals.trace(named)[: residuals.rows], np.linalg.norm(residuals.whitened(named), axis=0)
    basis = orthonormal(trace[:, np.linalg.norm(trace, axis=0) > INVISIBLE * raw], NEW_DIRECTION)
    return z - basis @ (basis.T @ z), freedom - (basis**2).sum(axis=1)


def restart_from(state: SearchState, baseline: Baseline) -> SearchState:
    """The search begun anew with another baseline; what the file states of the noise is kept."""
    again = begin(baseline, state.history, state.catalogue)
    return replace(again, stated=state.stated, noise_claims=state.noise_claims, apart=state.apart)
