"""A name claims that the cause fits, not that it is nearest."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.diagnosis.selection.forward import with_structures
from estimator.diagnosis.selection.lack_of_fit import (
    explained,
    with_unlike_noise,
    without_common_rows,
    without_misfits,
)
from estimator.diagnosis.signatures.noise import ExcessVariance
from tests.estimator.diagnosis.selection.small import ROWS, SENSOR, candidate, effect, names, on_sensor, start

NOISE = np.random.default_rng(4).standard_normal(ROWS)


def test_the_nearest_cause_goes_where_what_it_leaves_is_structure() -> None:
    state = start(("scale-asymmetry",), effect("cross-coupling") + effect("scale-asymmetry"))
    named = with_structures(replace(state, detections=(candidate(state, "scale-asymmetry"),)))
    left = without_misfits(named)
    assert names(left) == []
    assert left.structures or left.autocorrelated


def test_a_cause_that_fits_stays() -> None:
    state = start(("scale-asymmetry",), effect("scale-asymmetry"))
    named = with_structures(replace(state, detections=(candidate(state, "scale-asymmetry"),)))
    assert names(without_misfits(named)) == [("scale-asymmetry", (SENSOR,))]


@pytest.mark.parametrize(
    ("followed", "stays"),
    [
        pytest.param(40.0, True, id="it follows the course and departs from it"),
        pytest.param(1.0, False, id="it has another course"),
    ],
)
def test_a_sensor_of_a_shared_course_goes_only_where_it_departs_more_than_it_follows(
    followed: float, stays: bool
) -> None:
    place = np.linspace(-1, 1, ROWS)
    added = sum((on_sensor(size * place, i) for i, size in ((0, 40.0), (1, followed), (2, -30.0), (3, 20.0))), 0.0)
    state = start(("bias-ramp",), added + on_sensor(6 * np.sin(3 * np.pi * place)))
    event = tuple(replace(candidate(state, "bias-ramp", (i,)), event=(0, 1, 2, 3)) for i in range(4))
    named = with_structures(replace(state, detections=event))
    assert (SENSOR,) in {s.best.sensors for s in named.structures}
    assert (("bias-ramp", (SENSOR,)) in names(without_misfits(named))) == stays


def test_structure_on_another_sensor_is_none_of_its_business() -> None:
    state = start(("scale-asymmetry",), effect("scale-asymmetry") + effect("cross-coupling", 3))
    named = with_structures(replace(state, detections=(candidate(state, "scale-asymmetry"),)))
    left = without_misfits(named)
    assert names(left) == [("scale-asymmetry", (SENSOR,))]
    assert {s.best.sensors for s in left.structures} == {(3,)}


def test_what_a_name_explains_is_its_statistic() -> None:
    state = start(("scale-asymmetry",), effect("scale-asymmetry"))
    finding = candidate(state, "scale-asymmetry")
    assert explained(state, (finding,)) == pytest.approx(finding.best.statistic)


@pytest.mark.parametrize(
    ("course", "unlike"),
    [
        pytest.param(NOISE, False, id="normal"),
        pytest.param(np.where(np.arange(ROWS) == 7, 60.0, NOISE), True, id="one row far out"),
        pytest.param(np.sign(NOISE), True, id="one of two values"),
    ],
)
def test_scatter_that_is_not_distributed_as_noise_is_no_excess_noise(course: np.ndarray, unlike: bool) -> None:
    state = start((), on_sensor(20 * course))
    doubted = state.baseline.unstated.copy()
    doubted[SENSOR] = True
    state = replace(state, residuals=replace(state.residuals, baseline=replace(state.baseline, unstated=doubted)))
    left = with_unlike_noise(replace(state, excess=(ExcessVariance(SENSOR, 400.0, 19.0, 50.0, 1e-20),)))
    assert bool(left.unlike_noise) == unlike
    assert bool(left.excess) != unlike


def test_rows_in_which_most_sensors_stand_out_are_no_matter_of_the_sensors() -> None:
    far = np.where(np.arange(ROWS) == 7, 30.0, 0.0)
    everywhere = sum((on_sensor(far, sensor) for sensor in range(4)), np.zeros((ROWS, 4)))
    state = start(("reading-outlier",), everywhere)
    found = tuple(candidate(state, "reading-outlier", (sensor,)) for sensor in range(4))
    left = without_common_rows(replace(state, detections=found))
    assert names(left) == []
    assert len(left.structures) == 4
    assert without_common_rows(replace(state, detections=found[:1])).detections == found[:1]
