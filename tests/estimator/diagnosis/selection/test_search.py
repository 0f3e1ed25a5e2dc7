"""Every finding is weighed again given the others, and names against structure without a name."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.diagnosis.selection.forward import with_structures
from estimator.diagnosis.selection.search import (
    best_common_pair,
    groups,
    overlaps,
    reselected,
    search,
    structures_or_names,
    without_names,
)
from estimator.diagnosis.selection.search_state import SearchState
from tests.estimator.diagnosis.selection.small import BETA, SENSOR, candidate, effect, names, on_sensor, start

COMMON = ("beta-eccentricity", "beta-second-harmonic", "axis-wobble", "flip-misalignment", "alpha-shift", "stand-drift")
HARMONIC = on_sensor(20 * np.sin(4 * BETA + 0.3))


def patched(
    identifiers: tuple[str, ...], added: np.ndarray, chosen: tuple[tuple[str, tuple[int, ...]], ...]
) -> SearchState:
    """A search that selected these causes on these sensors so far."""
    state = start(identifiers, added)
    for identifier, sensors in chosen:
        state = replace(state, detections=(*state.detections, candidate(state, identifier, sensors)))
    return state


def test_a_first_choice_that_was_wrong_is_selected_anew() -> None:
    state = patched(("warm-up", "bias-ramp"), effect("bias-ramp"), (("warm-up", (SENSOR,)),))
    assert names(reselected(state)) == [("bias-ramp", (SENSOR,))]


def test_what_was_missed_is_found_when_the_others_are_right() -> None:
    state = patched(
        ("warm-up", "bias-ramp", "cubic-nonlinearity"),
        effect("bias-ramp") + effect("cubic-nonlinearity"),
        (("warm-up", (SENSOR,)),),
    )
    assert ("cubic-nonlinearity", (SENSOR,)) in names(reselected(state))


@pytest.mark.parametrize("pair", [("axis-wobble", "beta-eccentricity"), ("alpha-shift", "stand-drift")])
def test_two_causes_of_the_stand_are_found_together_where_two_others_stood_in_for_them(pair: tuple[str, str]) -> None:
    chosen = (("beta-second-harmonic", ()), ("flip-misalignment", ()))
    state = patched(COMMON, effect(pair[0]) + effect(pair[1]), chosen)
    assert names(best_common_pair(state)) == [(identifier, ()) for identifier in pair]


def test_a_single_cause_of_the_stand_is_no_pair() -> None:
    state = patched(COMMON, effect("alpha-shift"), (("alpha-shift", ()),))
    assert best_common_pair(state) is state


def test_a_right_pair_stays() -> None:
    state = patched(COMMON, effect("alpha-shift") + effect("stand-drift"), (("alpha-shift", ()), ("stand-drift", ())))
    assert best_common_pair(state).detections == state.detections


def test_a_name_on_structure_outside_the_catalogue_is_withdrawn() -> None:
    state = structures_or_names(with_structures(patched(("bias-jump",), HARMONIC, (("bias-jump", (SENSOR,)),))))
    assert names(state) == []
    assert [s.best.cause.identifier for s in state.structures] == ["sensor-harmonic"]


def test_a_true_name_is_not_withdrawn() -> None:
    state = patched(("cubic-nonlinearity",), effect("cubic-nonlinearity"), (("cubic-nonlinearity", (SENSOR,)),))
    assert structures_or_names(with_structures(state)).detections == state.detections


def test_a_true_name_on_another_sensor_stays_where_one_is_withdrawn() -> None:
    added = HARMONIC + effect("cubic-nonlinearity", 2)
    chosen = (("bias-jump", (SENSOR,)), ("cubic-nonlinearity", (2,)))
    state = structures_or_names(with_structures(patched(("bias-jump", "cubic-nonlinearity"), added, chosen)))
    assert names(state) == [("cubic-nonlinearity", (2,))]


def test_structure_takes_the_place_of_a_name_on_its_own_sensor_only() -> None:
    state = patched(("bias-jump",), HARMONIC + np.roll(HARMONIC, 2, axis=1), (("bias-jump", (SENSOR,)),))
    rival = without_names(state, state.detections)
    assert (3,) not in {s.best.sensors for s in rival.structures}
    assert rival.patterns is state.patterns


def test_what_structure_may_replace_is_everything_each_sensor_and_each_name() -> None:
    chosen = (("bias-jump", (0,)), ("bias-ramp", (0,)), ("bias-ramp", (1,)))
    state = patched(("bias-jump", "bias-ramp"), HARMONIC, chosen)
    a, b, c = state.detections
    assert groups(state) == [(a, b, c), (a, b), (c,), (a,), (b,)]


def test_structure_overlaps_names_on_its_sensor() -> None:
    state = with_structures(start(("bias-jump",), HARMONIC))
    own, other = (candidate(state, "bias-jump", (i,)) for i in (SENSOR, 3))
    assert overlaps((own,), state.structures)
    assert not overlaps((other,), state.structures)


def test_the_whole_search_names_causes_and_leaves_structure_unnamed() -> None:
    added = HARMONIC + effect("cubic-nonlinearity", 2)
    state = search(start(("cubic-nonlinearity", "bias-jump", "bias-ramp"), added))
    assert names(state) == [("cubic-nonlinearity", (2,))]
    assert {s.best.sensors for s in state.structures} == {(SENSOR,)}
