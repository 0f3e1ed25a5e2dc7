"""Effect of temperature in a session, by the law of the sessions before it."""

from collections.abc import Sequence

import numpy as np
import pytest

from estimator.health import ParameterJudgement, judge
from estimator.health.temperature_law import Seen, TemperatureStep, can_tell, temperature_steps
from estimator.session import ACCELEROMETER, Array
from tests.estimator.health.cases import TOLERANCES, calibration, sensor

BIAS, SCALE = TOLERANCES[ACCELEROMETER, "bias"], TOLERANCES[ACCELEROMETER, "scale"]
U_BIAS, U_SCALE = 0.04 * BIAS, 0.04 * SCALE
SEASONS = (20.0, 34.0, 22.0, 12.0, 30.0, 16.0, 26.0, 35.0, 18.0)
PER_DEGREE = 0.15
"""T, more than two tolerances from 20 to 35 °C."""


def session(bias: float, scale: float = 0.0, rng: np.random.Generator | None = None) -> Seen:
    """A session with a bias and a change of the scale factor, T; measured with noise where there is any."""
    noise = np.zeros(2) if rng is None else rng.standard_normal(2)
    of_bias = bias * BIAS + noise[0] * U_BIAS
    of_scale = -0.12 * (1 + scale * SCALE + noise[1] * U_SCALE)
    return Seen(0.0, 20.0, calibration(sensor(bias=(of_bias, U_BIAS), scale=(of_scale, 0.12 * U_SCALE))))


def life(bias: Array, warm: Sequence[float], rng: np.random.Generator) -> list[Seen]:
    """Sessions four months apart of a sensor whose bias, T, is given, and whose scale factor follows half of it."""
    made = [session(b, b / 2, rng) for b in bias]
    return [Seen(i / 3, t, one.calibration) for i, (t, one) in enumerate(zip(warm, made, strict=True))]


def judged(lived: Sequence[Seen], last: Seen, celsius: float) -> dict[str, ParameterJudgement]:
    """A session at so many °C after the others, the first of which is the reference, by parameter."""
    reference = lived[0].calibration
    steps = temperature_steps(lived, reference, (lived[0].celsius, celsius), TOLERANCES)
    return {j.parameter: j for j in judge(last.calibration, reference, TOLERANCES, steps=steps)}


@pytest.mark.parametrize("bend", [0.0, 0.006], ids=["line", "parabola"])
def test_a_session_is_judged_at_the_temperature_of_its_reference(bend: float) -> None:
    rng = np.random.default_rng(1)
    away = np.array([*SEASONS, 33.0]) - 20.0
    *bias, last = PER_DEGREE * away + bend * away**2
    found = judged(life(np.array(bias), SEASONS, rng), session(last, last / 2, rng), 33.0)
    for parameter, worth in (("bias", last * BIAS), ("scale", last / 2 * SCALE)):
        one, taken = found[parameter], found[parameter].temperature_correction
        assert taken is not None
        assert one.verdict == "pass"
        assert taken.measured == pytest.approx(worth, rel=0.1)
        assert (taken.temperature, taken.reference_temperature, taken.sessions) == (33.0, 20.0, len(SEASONS))
        assert one.deviation == pytest.approx(taken.corrected)
        assert one.expanded == pytest.approx(taken.expanded)
    assert found["bias"].value == pytest.approx(last * BIAS, rel=0.1)
    assert found["axis"].temperature_correction is None


def test_a_sensor_that_moved_beside_its_law_fails() -> None:
    rng = np.random.default_rng(2)
    bias = PER_DEGREE * (np.array(SEASONS) - 20.0)
    found = judged(life(bias, SEASONS, rng), session(PER_DEGREE * 13 + 2.0, rng=rng), 33.0)
    assert found["bias"].verdict == "fail"
    assert found["bias"].deviation == pytest.approx(2 * BIAS, rel=0.2)


def test_a_step_that_came_with_a_warmer_room_is_no_law() -> None:
    """Nobody can tell whether the sensor changed or the room."""
    rng = np.random.default_rng(3)
    warm = (20.0, 20.5, 19.5, 20.2, 34.6, 35.3, 35.0, 34.8)
    bias = 2.0 * (np.array(warm) > 30)
    found = judged(life(bias, warm, rng), session(2.0, 1.0, rng), 35.0)
    assert found["bias"].temperature_correction is None
    assert found["bias"].verdict == "fail"


def test_a_sensor_that_follows_nothing_is_left_as_it_is() -> None:
    rng = np.random.default_rng(4)
    lived = life(np.zeros(len(SEASONS)), SEASONS, rng)
    assert temperature_steps(lived, lived[0].calibration, (20.0, 33.0), TOLERANCES) == {}


@pytest.mark.slow
@pytest.mark.parametrize("scatter", [0.0, 0.15], ids=["noise", "hysteresis"])
def test_u_covers_what_the_law_leaves(scatter: float) -> None:
    """U is tried in 200 sensors, with a bend too small to be seen in most."""
    covered = []
    for seed in range(200):
        rng = np.random.default_rng((5, seed))
        warm = np.array([20.0, *rng.permutation(SEASONS), rng.uniform(14, 33)])
        away = warm - 20.0
        bias = rng.normal(0, PER_DEGREE) * away + rng.normal(0, 0.002) * away**2 + rng.normal(0, scatter, len(away))
        found = judged(life(bias[:-1], warm[:-1].tolist(), rng), session(bias[-1], rng=rng), float(warm[-1]))["bias"]
        if found.temperature_correction is not None and found.deviation is not None:
            covered.append(abs(found.deviation) <= (found.expanded or 0.0))
    assert len(covered) > 150
    assert 0.91 <= np.mean(covered) <= 0.99


@pytest.mark.parametrize(
    ("learned", "now", "known"),
    [
        pytest.param(SEASONS, 33.0, True, id="among others"),
        pytest.param(SEASONS, 39.0, True, id="a little beyond them"),
        pytest.param(SEASONS, 42.0, False, id="far beyond them"),
        pytest.param((20.0, 21.0, 20.0, 35.0, 34.0, 35.0), 27.5, False, id="in a gap"),
        pytest.param(SEASONS, 20.5, False, id="at the reference's temperature"),
        pytest.param(SEASONS[:5], 33.0, False, id="few"),
        pytest.param((20.0, 20.5, 19.5, 20.2, 19.8, 20.1), 22.0, False, id="all at one temperature"),
    ],
)
def test_sessions_must_be_enough_and_lie_about(learned: tuple[float, ...], now: float, known: bool) -> None:
    assert can_tell(learned, 20.0, now) is known


def test_a_step_of_a_sensor_that_the_session_lacks_changes_nothing() -> None:
    steps = {("A9", "bias"): TemperatureStep(BIAS, 0.0, None, 35.0, 20.0, 6)}
    one = session(0.2).calibration
    plain = judge(one, session(0.0).calibration, TOLERANCES)
    assert judge(one, session(0.0).calibration, TOLERANCES, steps=steps) == plain
