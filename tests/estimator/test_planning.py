"""Plans of sessions on the two-axis stand: what they promise is what a session gives, what they propose is best."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import ScheduleError, Site, Stand, StandErrors, calibrate
from estimator.parameters import nominal
from estimator.planning import Plan, Request, ToleranceSet, optimal_elevation, plan
from estimator.planning.elevation import conditioning
from estimator.planning.positions import log_information, whitened
from estimator.session import CalibrationSession, Sensor
from estimator.simulate import simulate, stand_schedule
from tests.builders import ARCSEC, GRAVITY
from tests.estimator.calibration.cases import SITE, STAND, accelerometers, gyros
from tests.estimator.calibration.cases import block as block_on_fixture

NOISE = np.full(6, np.hypot(2.5e-5, 2e-5 / 3 * 9.8))
"""Noise at the input, m/s²."""
PUBLISHED = StandErrors(theta_x=ARCSEC / 3, theta_y=ARCSEC / 3, alpha=ARCSEC, beta=ARCSEC)


def block(sensors: tuple[Sensor, ...], positions: int = 12, **how: object) -> CalibrationSession:
    """A schedule with the cone's axis along the head."""
    return block_on_fixture(sensors, positions, **({"mounting": np.eye(3)} | how))


@pytest.fixture(scope="module")
def unasked() -> Plan:
    """The plan for the published block when nothing is asked for."""
    return plan(block(accelerometers(), 24), sigma=NOISE)


@pytest.mark.parametrize(("N", "degrees"), [(12, 40.2), (24, 40.0), (36, 39.9)])
def test_the_published_optimal_elevation(N: int, degrees: float) -> None:
    assert np.degrees(optimal_elevation(PUBLISHED, N)) == pytest.approx(degrees, abs=0.05)


def test_a_perfect_stand_has_no_preference() -> None:
    assert optimal_elevation(StandErrors(), 12) == pytest.approx(np.pi / 4)


def test_conditioning_does_not_depend_on_the_number_of_positions() -> None:
    found = [conditioning(block(accelerometers(), N)) for N in (6, 12, 36)]
    assert np.ptp(found) < 1e-9
    assert found[0] == pytest.approx(10.0, rel=0.01)


def test_conditioning_is_nearly_least_where_the_paper_says() -> None:
    angles = np.radians([20, 30, 40, 47, 55, 70])
    found = [conditioning(replace(block(accelerometers()), stand=replace(STAND, alpha=float(a)))) for a in angles]
    assert max(found[2:5]) < 1.25 * min(found)
    assert min(found[0], found[5]) > 1.35 * min(found)


def test_expected_sigmas_are_those_of_a_simulated_session(unasked: Plan) -> None:
    schedule, rng = unasked.schedule, np.random.default_rng(1)
    noise = schedule.standard_errors[0]
    measured = calibrate(simulate(schedule, nominal(schedule.sensors), rng, noise=noise))
    for expected, found in zip(unasked.expected.sensors, measured.sensors, strict=True):
        for name in ("scale", "bias", "quadratic"):
            assert getattr(found, name).sigma == pytest.approx(getattr(expected, name).sigma, rel=0.01)
        assert found.axis_sigma == pytest.approx(expected.axis_sigma, rel=0.01)


def test_the_proposed_elevation_is_the_least_of_what_it_minimises(unasked: Plan) -> None:
    def mean_square(p: Plan) -> float:
        used = [j.sigma for j in p.judged if j.parameter in ("scale", "axis") and j.sigma is not None]
        return float(np.mean(np.square(used)))

    near = [plan(unasked.schedule, Request(elevation=unasked.elevation + d, positions=24)) for d in (-0.05, 0.05)]
    assert mean_square(unasked) < min(map(mean_square, near))
    assert np.degrees(unasked.elevation) == pytest.approx(39.4, abs=0.3)


def test_the_fewest_positions_that_reach_the_tolerances() -> None:
    like = block(accelerometers(), 24)
    request = Request(elevation=np.radians(40.0), wanted=ToleranceSet(bias=12e-6 * 9.80665))
    found = plan(like, request, sigma=NOISE)
    fewer = plan(like, replace(request, positions=found.positions - 1), sigma=NOISE)
    assert found.reached
    assert not fewer.reached
    assert found.seconds == 2 * found.positions * 120.0


def test_what_the_stand_cannot_reach_is_said() -> None:
    poor = replace(STAND, sigma=replace(PUBLISHED, alpha=60 * ARCSEC))
    like = replace(block(accelerometers(), 24), stand=poor)
    found = plan(like, Request(wanted=ToleranceSet(axis=30 * ARCSEC)), sigma=NOISE)
    assert found.reached is False
    assert {j.verdict for j in found.judged if j.parameter == "axis"} == {"undecidable"}
    assert found.positions < found.request.most_positions


def test_one_run_names_what_it_does_not_see() -> None:
    found = plan(block(accelerometers(), 24), Request(positions=12, runs=(False,)), sigma=NOISE)
    assert {"A1.scale", "A1.bias", "A1.axis"} <= set(found.unseen)
    assert "A1.quadratic" not in found.unseen
    assert {limit.cause for limit in found.limits if "both runs" in limit.reason} >= {
        "levelling-y",
        "flip-misalignment",
    }


def test_limits_say_what_would_be_detected(unasked: Plan) -> None:
    found = {limit.cause: limit for limit in unasked.limits}
    assert found["gravity-entry"].amplitude is None
    assert found["bias-temperature"].reason == "the session lacks temperature"
    (jump,) = found["bias-jump"].amplitude or (0.0,)
    assert 1e-6 * 9.8 < jump < 500e-6 * 9.8


def test_optimal_positions_tell_at_least_as_much_as_equal_steps(unasked: Plan) -> None:
    s, best = unasked.schedule, unasked.optimal
    assert s.beta is not None
    assert s.flipped is not None
    equal = log_information(whitened(s, s.beta, s.flipped, NOISE))
    found = log_information(whitened(s, best.beta, best.flipped, NOISE))
    assert found - equal == pytest.approx(-30 * np.log(best.efficiency), abs=1e-6)
    assert 0.98 < best.efficiency <= 1
    assert len(best.beta) == len(s.beta)


def test_optimal_positions_beat_a_quarter_turn() -> None:
    schedule = block(accelerometers(), 12)
    assert schedule.beta is not None
    narrow = replace(schedule, beta=schedule.beta / 4)
    found = plan(narrow, Request(positions=12), sigma=NOISE)
    beta, flipped = found.optimal.beta, found.optimal.flipped
    assert np.ptp(beta) > np.pi
    gain = log_information(whitened(narrow, beta, flipped, NOISE)) - log_information(
        whitened(narrow, narrow.beta, narrow.flipped, NOISE)
    )
    assert gain > 10


def test_noise_is_taken_from_a_session_that_states_none() -> None:
    schedule, rng = block(accelerometers(), 24), np.random.default_rng(2)
    measured = simulate(schedule, nominal(schedule.sensors), rng, noise=3e-6, state_noise=False)
    found = plan(measured, Request(positions=24, elevation=STAND.alpha))
    stated = plan(schedule, Request(positions=24, elevation=STAND.alpha), sigma=NOISE)
    sigmas = [np.array([j.sigma for j in p.judged if j.parameter == "bias"]) for p in (found, stated)]
    assert sigmas[0].mean() == pytest.approx(sigmas[1].mean(), rel=0.15)


def test_gyros_are_planned_by_their_own_elevation() -> None:
    stand = Stand("ODG-1", chi=np.radians(40.0), sigma=replace(PUBLISHED, latitude=ARCSEC, meridian=5 * ARCSEC))
    like = stand_schedule(gyros(), stand, Site(latitude=SITE.latitude), 12, count_time=100.0)
    found = plan(like, sigma=np.full(6, 7e-8))
    assert found.schedule.stand is not None
    assert found.schedule.stand.chi == found.elevation
    assert found.formula_elevation < np.radians(36)
    assert not found.unseen


def test_a_mixed_block_moves_both_elevations_together() -> None:
    stand = replace(STAND, alpha=np.radians(40.0), chi=np.radians(50.0))
    like = replace(block((*accelerometers(3), *gyros(3)), count_time=100.0), stand=stand)
    found = plan(like, Request(elevation=np.radians(45.0), positions=8), sigma=np.repeat([6e-5, 7e-8], 3))
    assert found.schedule.stand is not None
    assert found.schedule.stand.chi == pytest.approx(np.radians(55.0))


def test_the_plan_is_a_document(unasked: Plan) -> None:
    document = unasked.to_dict()
    assert document["format"] == "imu-plan/1"
    assert len(document["parameters"]) == 24
    assert len(document["optimal_positions"]["beta_deg"]) == 48


def test_what_has_no_stand_is_refused() -> None:
    like: CalibrationSession = replace(block(accelerometers()), programme="arbitrary-orientations")
    with pytest.raises(ScheduleError, match="no stand"):
        plan(like)


def test_gravity_is_that_of_the_site(unasked: Plan) -> None:
    assert unasked.schedule.site == SITE
    assert np.abs(unasked.schedule.readings).max() < 0.12 * GRAVITY * 1.01
