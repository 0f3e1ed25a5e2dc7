"""A session judged against its reference: deviations, states, and how often a healthy unit is called unfit."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from estimator.health import ParameterJudgement, judge
from estimator.health.rule import critical_factors
from estimator.results import Estimate
from estimator.session import ACCELEROMETER, GYROSCOPE
from tests.estimator.health.cases import TOLERANCES, calibration, sensor

PARAMETERS = ("scale", "bias", "quadratic", "axis")
SPREAD = {"scale": 0.12 * 1e-5, "bias": 2e-5, "quadratic": 1e-7}
TIGHT = np.eye(2) * 1e-6**2


def judged(current: dict[str, object], reference: dict[str, object] | None = None) -> dict[str, ParameterJudgement]:
    """Judgements of one sensor by parameter."""
    then = calibration(sensor(**(reference or {}), covariance=TIGHT))
    now = calibration(sensor(**({"covariance": TIGHT} | current)))
    return {j.parameter: j for j in judge(now, then, TOLERANCES)}


def test_a_scale_deviates_relative_to_the_reference() -> None:
    found = judged({"scale": (0.12 * 1.0003, 6e-7)}, {"scale": (0.12, 8e-7)})["scale"]
    assert found.deviation == pytest.approx(3e-4)
    assert found.uncertainty == pytest.approx(1e-6 / 0.12, rel=1e-3)  # 6 and 8 in quadrature are 10
    assert found.verdict == "fail"


def test_uncertainties_of_both_sessions_add_in_quadrature() -> None:
    found = judged({"bias": (1e-4, 3e-5)}, {"bias": (0.0, 4e-5)})["bias"]
    assert (found.deviation, found.uncertainty) == pytest.approx((1e-4, 5e-5))
    assert found.expanded == pytest.approx(1e-4)
    assert found.verdict == "pass"


def test_the_probability_of_being_out_is_that_of_both_tails() -> None:
    found = judged({"bias": (1e-4, 4e-4)})["bias"]
    assert found.probability_out == pytest.approx(stats.norm.sf(1.0) + stats.norm.sf(1.5))


def test_an_axis_is_judged_by_its_angle() -> None:
    found = judged({"offset": (3e-4, 4e-4)})["axis"]
    assert (found.value, found.reference) == pytest.approx((5e-4, 0.0))
    assert found.deviation == pytest.approx(5e-4, rel=1e-4)
    assert found.uncertainty == pytest.approx(1e-6 * 2**0.5, rel=1e-3)
    assert found.verdict == "fail"


def test_a_reversed_axis_is_half_a_turn_away() -> None:
    found = judged({"offset": (np.pi, 0.0)})["axis"]
    assert found.value == pytest.approx(np.pi)
    assert found.verdict == "fail"


def test_what_a_session_does_not_observe_is_undecidable() -> None:
    found = judged({"bias": (None, None)})["bias"]
    assert (found.verdict, found.value, found.deviation) == ("undecidable", None, None)


def test_what_the_reference_did_not_observe_is_undecidable() -> None:
    found = judged({"quadratic": (1e-7, 1e-8)}, {"quadratic": (None, None)})["quadratic"]
    assert (found.verdict, found.value, found.reference) == ("undecidable", 1e-7, None)


def test_a_scale_has_no_relative_deviation_from_zero() -> None:
    found = judged({"scale": (0.12, 1e-6)}, {"scale": (0.0, 1e-6)})["scale"]
    assert (found.verdict, found.deviation) == ("undecidable", None)


def test_a_sensor_that_the_reference_lacks_is_undecidable() -> None:
    then, now = calibration(sensor("A1")), calibration(sensor("A9"))
    assert {j.verdict for j in judge(now, then, TOLERANCES)} == {"undecidable"}


def test_the_reference_itself_is_undecidable_and_its_own_origin() -> None:
    found = judge(calibration(sensor(bias=(1e-3, 1e-5))), None, TOLERANCES)
    assert {j.verdict for j in found} == {"undecidable"}
    assert [j.reference for j in found] == [0.12, 1e-3, 0.0, 0.0]


def test_a_parameter_without_a_tolerance_is_not_judged() -> None:
    only = {(ACCELEROMETER, "bias"): 5e-4}
    assert [j.parameter for j in judge(calibration(sensor()), calibration(sensor()), only)] == ["bias"]


def test_a_measurement_without_noise_is_judged_too() -> None:
    current, same = calibration(sensor(offset=(5e-4, 0.0))), calibration(sensor())
    assert [j.verdict for j in judge(current, same, TOLERANCES)] == ["pass", "pass", "pass", "fail"]


def found(parameter: str, now: float | None = None, then: float | None = None) -> ParameterJudgement:
    """A judgement of two sessions of equal sigmas, noise known to so many degrees of freedom."""
    current, origin = (
        calibration(replace(sensor(offset=offset, covariance=TIGHT), bias=Estimate(0.0, 3e-5, 3e-5, dof), axis_dof=dof))
        for offset, dof in (((5e-5, 0.0), now), ((0.0, 0.0), then))
    )
    return next(j for j in judge(current, origin, TOLERANCES) if j.parameter == parameter)


def critical(parameter: str, now: float | None = None, then: float | None = None) -> float:
    """The smallest change that counts, in standard uncertainties."""
    judgement = found(parameter, now, then)
    assert judgement.critical is not None
    return judgement.critical / (judgement.uncertainty or 0)


def test_a_change_of_a_number_is_measured_against_the_factor_of_numbers() -> None:
    assert critical("bias") == pytest.approx(critical_factors(4)[0])


def test_a_change_of_an_axis_is_measured_against_the_factor_of_vectors() -> None:
    """The angle's U is k times one of its two equal sigmas."""
    assert critical("axis") == pytest.approx(critical_factors(4)[1], rel=1e-3)


def test_noise_known_from_few_readings_asks_for_a_larger_change() -> None:
    assert critical("bias", now=8, then=8) == pytest.approx(critical_factors(4, dof=16)[0])


def test_the_degrees_of_freedom_of_both_sessions_count() -> None:
    """Equal sigmas: 4/(1/30 + 1/8)."""
    assert critical("bias", now=30, then=8) == critical("bias", now=8, then=30)
    assert critical("bias", now=30, then=8) == pytest.approx(critical_factors(4, dof=4 / (1 / 30 + 1 / 8))[0])


@pytest.mark.parametrize("parameter", ["bias", "axis"])
def test_few_degrees_of_freedom_widen_u_and_the_chance_to_be_out(parameter: str) -> None:
    known, few = found(parameter), found(parameter, now=3, then=3)
    assert few.dof == pytest.approx(6.0)
    assert few.coverage_factor == pytest.approx(2.52, abs=0.01)
    assert few.expanded == pytest.approx(few.coverage_factor * few.uncertainty)
    assert few.expanded > 1.2 * known.expanded
    assert few.probability_out > known.probability_out


def test_a_session_that_tells_no_noise_is_undecidable() -> None:
    blind = replace(sensor(covariance=np.full((2, 2), np.nan)), bias=Estimate(0.0, None))
    verdicts = {j.parameter: j.verdict for j in judge(calibration(blind), calibration(sensor()), TOLERANCES)}
    assert verdicts["bias"] == verdicts["axis"] == "undecidable"


def test_a_sensor_of_another_kind_is_no_reference() -> None:
    then = calibration(replace(sensor(), kind=GYROSCOPE))
    assert {j.verdict for j in judge(calibration(sensor()), then, TOLERANCES)} == {"undecidable"}


def healthy(rng: np.random.Generator, common: float) -> tuple[ParameterJudgement, ...]:
    """Six sensors that did not move, their errors correlated; every tolerance equals U, the hardest case."""
    shared = rng.standard_normal(5)
    draws = np.sqrt(common) * shared + np.sqrt(1 - common) * rng.standard_normal((6, 5))
    moved = [
        sensor(
            f"A{i}",
            scale=(0.12 * (1 + 4e-5 * z[0]), 0.12 * 4e-5),
            bias=(2e-4 * z[1], 2e-4),
            quadratic=(8e-7 * z[2], 8e-7),
            offset=(3e-5 * z[3], 3e-5 * z[4]),
            covariance=np.eye(2) * 3e-5**2,
        )
        for i, z in enumerate(draws)
    ]
    origin = [sensor(f"A{i}") for i in range(6)]
    return judge(calibration(*moved), calibration(*origin), TOLERANCES)


@pytest.mark.slow
@pytest.mark.parametrize("common", [0.0, 0.8])
def test_a_unit_at_its_reference_is_called_out_of_tolerance_in_less_than_one_percent(common: float) -> None:
    rng = np.random.default_rng(11)
    bad = {"fail", "conditional-fail"}
    sessions = [healthy(rng, common) for _ in range(200)]
    alarms = sum(any(j.verdict in bad for j in session) for session in sessions)
    beyond = sum(any(abs(j.deviation or 0) > j.tolerance for j in session) for session in sessions)
    assert alarms <= 6  # 200 sessions at 1 %: 2 expected at most, 6 is 2.8 sigma above
    assert beyond > 20  # without the level over the session, these would have been alarms


@pytest.mark.parametrize(("u", "true"), [(5e-5, 5e-4), (1.2e-4, 5e-4)])
def test_the_guard_band_keeps_its_meaning_at_the_edge_of_tolerance(u: float, true: float) -> None:
    """A bias exactly at its tolerance passes, and fails, with probability Φ(−2) at most."""
    rng = np.random.default_rng(12)
    only = {(ACCELEROMETER, "bias"): 5e-4}
    origin = calibration(sensor())
    verdicts = [
        judge(calibration(sensor(bias=(true + u * z, u))), origin, only)[0].verdict for z in rng.standard_normal(3000)
    ]
    allowed = 0.0228 * 3000 + 3 * (0.0228 * 3000) ** 0.5
    assert verdicts.count("pass") <= allowed
    assert verdicts.count("fail") <= allowed
    assert verdicts.count("conditional-pass") > 1000
