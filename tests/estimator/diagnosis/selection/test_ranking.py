"""The strongest signature given the others, and the evidence of several together."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.diagnosis.selection.ranking import (
    extended_basis,
    family_p_value,
    joint_log_evidence,
    on_other_sensors,
    strongest,
)
from estimator.diagnosis.selection.search_state import LEVEL, NAMED
from estimator.diagnosis.signatures.noise import Autocorrelation, ExcessVariance
from tests.estimator.diagnosis.selection.small import SENSOR, candidate, effect, start

FEW = ("cubic-nonlinearity", "bias-ramp", "beta-eccentricity")
CUBIC = effect("cubic-nonlinearity")


def test_every_place_and_every_cause_has_its_share_of_the_level() -> None:
    scored = replace(candidate(start(FEW), "cubic-nonlinearity").best, p_value=1e-4, places=4)
    assert family_p_value(scored, 10) == pytest.approx(4e-3)
    assert family_p_value(scored, 10**6) == 1.0


def test_the_strongest_is_the_cause_that_is_there() -> None:
    state = start(FEW, CUBIC)
    best = strongest(state, state.traces)
    assert best is not None
    assert best.best.group == ("cubic-nonlinearity", (SENSOR,))
    assert best.p_family < LEVEL


def test_a_name_beside_another_or_beside_noise_is_held_to_a_stricter_level_than_one_alone() -> None:
    sizes = (start(FEW, size * CUBIC) for size in np.linspace(0.05, 0.2, 100))
    alone = next(state for state in sizes if (best := strongest(state, state.traces)) and best.p_family > 1.2 * LEVEL)
    beside = replace(alone, detections=(candidate(alone, "bias-ramp", (3,)),))
    noisy = replace(alone, excess=(ExcessVariance(3, 4.0, 19.0, 9.0, 1e-5),))
    assert LEVEL < family_p_value(strongest(alone, alone.traces).best, alone.families) < NAMED
    assert strongest(beside, beside.traces) is None
    assert strongest(noisy, noisy.traces) is None
    again = replace(alone, detections=(candidate(alone, "cubic-nonlinearity"),))
    assert strongest(again, again.traces, without=again.detections[0]) is not None


def test_a_refuted_cause_is_not_chosen() -> None:
    state = replace(start(FEW, CUBIC), refuted=frozenset({("cubic-nonlinearity", (SENSOR,))}))
    best = strongest(state, state.traces)
    assert best is None or best.best.group != ("cubic-nonlinearity", (SENSOR,))


@pytest.mark.parametrize(("log_evidence", "named"), [(5.0, False), (0.5, True)])
def test_on_a_sensor_that_is_plainly_a_course_nothing_is_named(log_evidence: float, named: bool) -> None:
    course = Autocorrelation(SENSOR, "the order measured", log_evidence)
    state = replace(start(FEW, CUBIC), autocorrelated=(course,))
    best = strongest(state, state.traces)
    assert (best is not None and best.best.sensors == (SENSOR,)) == named


def test_a_finding_is_chosen_anew_on_its_own_sensor_or_as_common_to_all() -> None:
    state = start(FEW, CUBIC + 2 * effect("cubic-nonlinearity", 2))
    state = replace(state, detections=(candidate(state, "bias-ramp", (SENSOR,)),))
    again = strongest(state, state.traces, without=state.detections[0])
    assert again is not None
    assert again.best.sensors in ((), (SENSOR,))


def test_other_sensors_must_show_the_cause_themselves() -> None:
    state = start(FEW, CUBIC + effect("cubic-nonlinearity", 3))
    best = strongest(state, state.traces)
    assert best is not None
    assert {best.best.sensors, *(f.best.sensors for f in on_other_sensors(state, best, state.traces))} == {(1,), (3,)}


def test_one_sensor_alone_has_no_company() -> None:
    state = start(FEW, CUBIC)
    best = strongest(state, state.traces)
    assert best is not None
    assert on_other_sensors(state, best, state.traces) == []


def test_what_explains_the_same_adds_no_evidence() -> None:
    state = start(FEW, CUBIC)
    found = candidate(state, "cubic-nonlinearity")
    once, twice = (joint_log_evidence(replace(state, detections=(found,) * times)) for times in (1, 2))
    assert once == pytest.approx(found.best.log_evidence)
    assert twice < once


def test_evidence_of_structures_counts_too() -> None:
    state = start(FEW, CUBIC)
    found = candidate(state, "cubic-nonlinearity")
    as_structure, as_cause = replace(state, structures=(found,)), replace(state, detections=(found,))
    assert joint_log_evidence(as_structure) == joint_log_evidence(as_cause)


def test_a_basis_grows_by_what_is_new_only() -> None:
    rng = np.random.default_rng(1)
    basis, _ = np.linalg.qr(rng.normal(size=(20, 3)))
    new = 1e-3 * rng.normal(size=(20, 1))
    grown = extended_basis(basis, np.concatenate([basis @ rng.normal(size=(3, 1)), new, np.zeros((20, 1))], axis=1))
    assert grown.shape == (20, 4)
    assert np.allclose(grown.T @ grown, np.eye(4))
    assert np.allclose(grown @ (grown.T @ new), new, atol=1e-12)
