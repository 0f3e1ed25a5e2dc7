"""Zeros that step at one row are one event of all their sensors; zeros that change otherwise are none."""

import numpy as np
import pytest

from estimator import diagnose, read_session
from estimator.diagnosis import Finding
from tests.blind.steps import BLOCKS, RAMPS, TURNED, WALKS, Block, Stepped, draw_others, draw_steps

SHARED = "one step at the same moment"
STAND, ORIENTATIONS = BLOCKS[0], BLOCKS[2]


def found_in(hidden: Stepped) -> tuple[Finding, ...]:
    """Findings of the diagnosis."""
    return diagnose(read_session(hidden.session)).findings


@pytest.mark.slow
@pytest.mark.parametrize(
    ("block", "count", "seed"),
    [
        pytest.param(0, 4, (21, 0), id="4 of 6 on a stand"),
        pytest.param(2, 6, (21, 2), id="6 of 6 in orientations"),
        pytest.param(0, 5, (2095, 2, 5, 0), id="5 of 6, which scatter as if the stated noise were wrong"),
        pytest.param(2, 5, (2095, 4, 5, 0), id="5 of 6, the last following the others more than any of them shows"),
    ],
)
def test_zeros_that_step_together_are_one_finding_with_one_moment(
    block: int, count: int, seed: tuple[int, ...]
) -> None:
    hidden = draw_steps(BLOCKS[block], np.full(count, 12.0), np.random.default_rng(seed))
    (found,) = found_in(hidden)
    assert found.cause == "bias-jump"
    assert set(found.sensors) <= set(hidden.sensors)
    assert len(found.sensors) >= count - 1, "one whose readings hardly show it is not named"
    assert {shape["row"] for shape in found.nonlinear_each} == set(hidden.rows)
    assert found.sentence.startswith("The biases of")
    assert SHARED in found.sentence
    size = dict(zip(found.sensors, zip(found.amplitude, found.sigma, strict=True), strict=True))
    true = dict(zip(hidden.sensors, hidden.size, strict=True))
    for sensor, (value, sigma) in size.items():
        assert abs(value - true[sensor]) < 4 * sigma


@pytest.mark.slow
def test_beside_jumps_of_eighty_standard_errors_no_other_sensor_seems_to_jump() -> None:
    for block in BLOCKS[:3]:
        hidden = draw_steps(block, np.full(3, 80.0), np.random.default_rng((23, 3)))
        (found,) = found_in(hidden)
        assert set(found.sensors) == set(hidden.sensors)


def test_zeros_that_step_apart_are_no_event() -> None:
    hidden = draw_steps(BLOCKS[0], np.full(2, 12.0), np.random.default_rng((22, 0)), apart=True)
    found = found_in(hidden)
    assert {f.cause for f in found} <= {"bias-jump"}
    assert all(SHARED not in f.sentence for f in found)
    assert len({shape["row"] for f in found for shape in f.nonlinear_each}) == 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "block", "strength", "seed"),
    [
        pytest.param(WALKS, STAND, 8.0, (6, 8, 0, 3, 0), id="walks on a stand"),
        pytest.param(WALKS, ORIENTATIONS, 20.0, (6, 20, 2, 5, 0), id="walks in orientations"),
        pytest.param(RAMPS, STAND, 8.0, (6, 8, 0, 9, 1), id="ramps on a stand"),
        pytest.param(RAMPS, ORIENTATIONS, 20.0, (6, 20, 2, 3, 1), id="ramps in orientations"),
        pytest.param(TURNED, STAND, 20.0, (2096, 82, 26), id="a block that turned"),
    ],
)
def test_what_every_sensor_shows_otherwise_is_no_step(
    kind: str, block: Block, strength: float, seed: tuple[int, ...]
) -> None:
    hidden = draw_others(block, kind, strength, np.random.default_rng(seed))
    assert all(SHARED not in f.sentence for f in found_in(hidden))
