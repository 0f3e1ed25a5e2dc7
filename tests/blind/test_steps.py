"""Zeros that step at one row are one event of all their sensors; zeros that step one by one are not."""

import numpy as np
import pytest

from estimator import diagnose, read_session
from estimator.diagnosis import Finding
from tests.blind.steps import BLOCKS, Stepped, draw_steps


def found_in(hidden: Stepped) -> tuple[Finding, ...]:
    """What a diagnosis names."""
    return diagnose(read_session(hidden.session)).findings


@pytest.mark.parametrize(
    ("block", "count"), [pytest.param(0, 4, id="4 of 6 on a stand"), pytest.param(2, 6, id="6 of 6 in orientations")]
)
def test_zeros_that_step_together_are_one_finding_with_one_moment(block: int, count: int) -> None:
    hidden = draw_steps(BLOCKS[block], np.full(count, 12.0), np.random.default_rng((21, block)))
    (found,) = found_in(hidden)
    assert (found.cause, set(found.sensors)) == ("bias-jump", set(hidden.sensors))
    assert {shape["row"] for shape in found.nonlinear_each} == set(hidden.rows)
    assert found.sentence.startswith("The zeros of")
    assert "at one moment" in found.sentence
    size = dict(zip(found.sensors, zip(found.amplitude, found.sigma, strict=True), strict=True))
    for sensor, true in zip(hidden.sensors, hidden.size, strict=True):
        value, sigma = size[sensor]
        assert abs(value - true) < 4 * sigma


def test_zeros_that_step_apart_are_no_event() -> None:
    hidden = draw_steps(BLOCKS[0], np.full(2, 12.0), np.random.default_rng((22, 0)), apart=True)
    found = found_in(hidden)
    assert {f.cause for f in found} <= {"bias-jump"}
    assert all("at one moment" not in f.sentence for f in found)
    assert len({shape["row"] for f in found for shape in f.nonlinear_each}) == 2
