"""Acceptance of the search's result: a name claims that the cause fits, not merely that it is nearest."""

from dataclasses import replace

from estimator.diagnosis.selection.chosen_again import without_unpredictive
from estimator.diagnosis.selection.common_or_own import with_events, with_likelier_vector_course
from estimator.diagnosis.selection.confirmation import doubtful_claims, hold_jointly
from estimator.diagnosis.selection.heavy_tails import without_names_of_tails
from estimator.diagnosis.selection.lack_of_fit import with_unlike_noise, without_common_rows, without_misfits
from estimator.diagnosis.selection.noise_beside import with_noise_beside_effects
from estimator.diagnosis.selection.noise_claim import (
    doubted,
    is_one_sensor,
    of_whole_kinds,
    sensors_of,
    with_quieter_kinds_whole,
    with_unknown_scale,
    without_names_in_no_noise,
)
from estimator.diagnosis.selection.refinement import with_refined_shapes
from estimator.diagnosis.selection.search import search
from estimator.diagnosis.selection.search_state import Detection, SearchState
from estimator.diagnosis.selection.shared_event import (
    departures,
    is_apart,
    is_plainly_shared,
    searched_with_event,
    shared_event,
)
from estimator.diagnosis.signatures.noise import NoiseClaim


def accepted(start: SearchState) -> SearchState:
    """The causes that hold, the stated noise believed or, where readings contradict it, known up to a factor only.

    An event of most sensors makes all of them scatter. It is one shape with a size of each, which cannot stand in for
    noise: where it leaves readings that scatter as stated, the stated noise is right; where not, what it leaves shows
    whose noise is wrong. A search in errors stated far too small names structure without end.
    """
    start = with_noise_beside_effects(start)
    start = replace(start, apart=True) if is_apart(start) else start
    claims, event = doubted(start), shared_event(start)
    claims = () if claims and not event and is_one_sensor(start) else claims
    left = left_claims(start, event) if event else claims
    if claims and left:
        found = under_free_scale(start, left) or accepted_against_course(start)
    else:
        found = accepted_against_course(start)
        claims = doubted(found) if not claims or explains_scatter(found) else claims
        found = (under_free_scale(start, claims) if claims else None) or found
    return without_names_of_tails(without_names_in_no_noise(confirmed(start, found)))


def left_claims(start: SearchState, event: tuple[Detection, ...]) -> tuple[NoiseClaim, ...]:
    """The noise claims that a shared course leaves in doubt, sensors that depart from it taken off too."""
    return doubted(replace(start, detections=(*event, *departures(start))))


def explains_scatter(state: SearchState) -> bool:
    """Whether a course that sensors share stands, and no residual scatters otherwise than stated."""
    return len([f for f in state.detections if f.event]) > 1 and not (state.scatter or state.structures)


def confirmed(start: SearchState, state: SearchState) -> SearchState:
    """The state with names only that hold whether or not the stated noise that they rest on is right.

    Where one does not, causes are sought anew with that noise known up to a factor. Nothing is claimed of it: its
    readings do not tell that it is wrong, nor do they confirm that it is right.
    """
    claims = state.noise_claims
    while doubt := doubtful_claims(state):
        claims = (*claims, *doubt)
        unknown = with_unknown_scale(start, claims, state.detections)
        if hold_jointly(unknown, state.detections):
            break
        state = replace(accepted_against_course(unknown), noise_claims=state.noise_claims)
    return state


def under_free_scale(start: SearchState, claims: tuple[NoiseClaim, ...]) -> SearchState | None:
    """The causes that hold with the noise of some sensors known up to a factor; None where what they leave scatters as
    stated.

    An effect may hide that a sensor's errors are off too, so that all of a kind are looked at; those whose errors then
    turn out to be right are believed again.
    """
    wide = of_whole_kinds(start, claims)
    accepted = accepted_against_course(with_unknown_scale(start, wide))
    doubts = doubted(accepted)
    again = with_quieter_kinds_whole(start, doubts)
    if doubts and sensors_of(again) != sensors_of(wide):
        accepted = accepted_against_course(with_unknown_scale(start, again, accepted.detections))
        doubts = doubted(accepted) or doubts
    return replace(accepted, noise_claims=doubts) if doubts else None


def accepted_against_course(start: SearchState) -> SearchState:
    """The causes that a search finds and that hold: they fit, and no course of the applied vector explains as much."""
    return with_unlike_noise(
        without_unpredictive(
            without_common_rows(with_likelier_vector_course(start, fitting_causes(start), fitting_causes))
        )
    )


def fitting_causes(start: SearchState) -> SearchState:
    """The causes that a search finds and that fit; what sensors share counts once."""
    plain = searched_with_event(start) if is_plainly_shared(start) else None
    if plain is not None:
        return without_misfits(with_refined_shapes(plain))
    state = without_misfits(with_refined_shapes(search(start)))
    shared = with_events(start, state)
    return state if shared is state else without_misfits(with_refined_shapes(shared))
