"""Hidden effects that one flaw each once kept from being named; what put the flaw right must keep finding them."""

import pytest

from tests.blind.cases import draw_at, draw_case
from tests.blind.examine import examine

SEED = 2028


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "cause"),
    [
        pytest.param(462, "beta-eccentricity", id="unstated noise lost under the stand's errors"),
        pytest.param(1877, "scale-asymmetry", id="unstated noise of few rows"),
        pytest.param(744, "gravity-entry", id="a move of all sensors against the scatter of one"),
        pytest.param(1386, "warm-up", id="absorbed by the history's calibration otherwise than by this one"),
        pytest.param(1668, "bias-ramp", id="absorbed otherwise, beside a rival with a free shape"),
        pytest.param(223, "axis-creep", id="contains the simpler cause that fits as well"),
        pytest.param(1251, "saturation", id="clipped in several rows"),
    ],
)
def test_it_is_named_or_listed(number: int, cause: str) -> None:
    outcome = examine(draw_case("single", (SEED, number), cause))
    assert outcome.good, outcome


@pytest.mark.slow
@pytest.mark.parametrize(
    "number",
    [
        pytest.param(13, id="a warm-up with noise nearly explains it"),
        pytest.param(28, id="two faults at once nearly explain it"),
        pytest.param(8, id="no noise stated: one jump nearly explains it"),
    ],
)
def test_a_random_walk_is_structure_and_no_cause(number: int) -> None:
    outcome = examine(draw_case("outside", (62, number), "random-walk"))
    assert outcome.good, outcome
    assert not outcome.findings


@pytest.mark.slow
@pytest.mark.parametrize("cause", ["beta-eccentricity", "beta-second-harmonic", "beta-scale", "flip-misalignment"])
def test_a_strong_error_of_the_stand_does_not_pass_for_noise_that_the_file_does_not_state(cause: str) -> None:
    case = draw_at(100.0, (777, 20), cause)
    assert not any(column.endswith("_se") for column in case.session["table"])
    outcome = examine(case)
    assert outcome.first, outcome
    assert len(outcome.findings) == 1
