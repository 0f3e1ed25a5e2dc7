"""What of the search is accepted: a name claims that the cause fits, not that it is nearest."""

from dataclasses import replace

from estimator.diagnosis.selection.chosen_again import without_unpredictive
from estimator.diagnosis.selection.common_or_own import common_or_own
from estimator.diagnosis.selection.lack_of_fit import with_unlike_noise, without_common_rows, without_misfits
from estimator.diagnosis.selection.noise_claim import doubted, with_unknown_scale
from estimator.diagnosis.selection.refinement import with_refined_shapes
from estimator.diagnosis.selection.search import search
from estimator.diagnosis.selection.search_state import SearchState


def accepted(start: SearchState) -> SearchState:
    """The causes that hold, the stated noise believed or, where readings contradict it, known up to a factor only."""
    claims, state = doubted(start), None
    if not claims:
        state = believed(start)
        claims = doubted(state)
    if claims:
        rival = believed(with_unknown_scale(start, claims))
        if confirmed := doubted(rival):
            return replace(rival, noise_claims=confirmed)
    return state or believed(start)


def believed(start: SearchState) -> SearchState:
    """The causes that a search finds and that hold: they fit, and no course of the applied vector explains as much."""
    return with_unlike_noise(without_unpredictive(without_common_rows(common_or_own(start, held(start), held))))


def held(start: SearchState) -> SearchState:
    """The causes that a search finds and that fit."""
    return without_misfits(with_refined_shapes(search(start)))
