"""A search with nothing found yet: the residuals of a session and the traces of every cause in them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.causes.contract import Cause, Signature
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.between_sessions import parameter_change
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.selection.search_state import SearchState
from estimator.diagnosis.signatures.lasting import traces_of
from estimator.diagnosis.signatures.noise import Autocorrelation, ExcessVariance
from estimator.diagnosis.signatures.patterns import PATTERNS


def begin(baseline: Baseline, history: Sequence[Baseline], catalogue: Sequence[Cause]) -> SearchState:
    """The search for causes of a catalogue in a fitted session; ``history`` in the frame of the session."""
    baseline = since(baseline, history)
    residuals = WhitenedResiduals.of(baseline, parameter_change(baseline, history))
    signatures = [c for c in catalogue if isinstance(c, Signature)]
    return SearchState(
        tuple(history),
        tuple(catalogue),
        residuals,
        tuple(traces_of(residuals, signatures)),
        tuple(traces_of(residuals, PATTERNS)),
        baseline.variance,
    )


def since(baseline: Baseline, history: Sequence[Baseline]) -> Baseline:
    """The baseline, which knows how the block sits turned since the latest of its history, where that can show."""
    alike = [h for h in history if h.setting.kinds == baseline.setting.kinds]
    turn = alike[-1].turn if alike and not baseline.gauge_free.any() else np.zeros(3)
    return replace(baseline, setting=replace(baseline.setting, turn=turn))


def begin_anew(state: SearchState, scatter: Sequence[ExcessVariance | Autocorrelation]) -> SearchState:
    """The search begun anew with one sensor's variance as it is, known from its own residuals alone."""
    variance, unstated = state.baseline.variance.copy(), state.baseline.unstated.copy()
    for one in scatter:
        variance[:, one.sensor] *= one.ratio
        unstated[one.sensor] = True
    again = begun_with(state, replace(state.baseline, variance=variance, unstated=unstated))
    excess = (*state.excess, *(s for s in scatter if isinstance(s, ExcessVariance)))
    autocorrelated = (*state.autocorrelated, *(s for s in scatter if isinstance(s, Autocorrelation)))
    return replace(again, excess=excess, autocorrelated=autocorrelated)


def begun_with(state: SearchState, baseline: Baseline) -> SearchState:
    """The search begun anew with another baseline; what the file states of the noise is kept."""
    again = begin(baseline, state.history, state.catalogue)
    return replace(again, stated=state.stated, noise_claims=state.noise_claims)
