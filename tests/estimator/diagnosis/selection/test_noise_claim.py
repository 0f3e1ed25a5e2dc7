"""The stated noise is a claim."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import stats
from scipy.optimize import brentq
from scipy.special import polygamma

from benchmarks.study.other_noise import Hidden, Wish, beside_gyros, in_logs, in_orientations
from estimator import diagnose, read_session
from estimator.causes import CATALOGUE, cause
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.selection.acceptance import left_claims, under_free_scale
from estimator.diagnosis.selection.noise_claim import doubted, pure_error, without_names_in_no_noise
from estimator.diagnosis.selection.shared_event import shared_event
from estimator.diagnosis.selection.start import begin
from estimator.diagnosis.signatures.noise import NoiseClaim
from estimator.session import ACCELEROMETER, CalibrationSession
from tests.blind.cases import draw_case
from tests.estimator.calibration.cases import accelerometers, block, gyros
from tests.estimator.causes.hiding import Scene
from tests.estimator.causes.physics import World
from tests.estimator.causes.worlds import truth_of, wandering
from tests.estimator.diagnosis.selection.small import SENSOR, candidate, effect, measured, start
from tests.estimator.diagnosis.selection.test_common_or_own import swaying

PAGE = Path(__file__).parents[4] / "docs" / "diagnosis" / "recordings" / "stated-errors.md"


def stated(session: CalibrationSession, factor: float, sensors: slice = slice(None)) -> CalibrationSession:
    """The session with some standard errors, of repetition too, stated too large by a factor."""
    errors, known = session.standard_errors.copy(), list(session.sensors)
    errors[:, sensors] *= factor
    known[sensors] = [replace(s, bias_repeatability=factor * s.bias_repeatability) for s in known[sensors]]
    return replace(session, standard_errors=errors, sensors=tuple(known))


@pytest.mark.parametrize("factor", [0.1, 1 / 3, 3.0])
def test_wrong_standard_errors_are_said_and_nothing_else(factor: float) -> None:
    found = diagnose(stated(measured(seed=3), factor))
    assert not found.findings
    assert not found.unexplained
    (scale,) = found.noise
    assert scale.factor == pytest.approx(1 / factor, rel=0.25)


@pytest.mark.slow
@pytest.mark.parametrize("factor", [0.1, 1 / 3, 3.0])
@pytest.mark.parametrize("identifier", ["bias-jump", "bias-ramp", "beta-second-harmonic"])
def test_a_cause_is_named_whatever_the_errors_are_stated_as(identifier: str, factor: float) -> None:
    found = diagnose(stated(measured(effect(identifier), 3), factor))
    assert [f.cause for f in found.findings] == [identifier]
    assert [scale.factor for scale in found.noise] == pytest.approx([1 / factor], rel=0.25)


@pytest.mark.parametrize("identifier", ["beta-second-harmonic", "stand-drift", "alpha-shift"])
def test_an_effect_that_all_sensors_show_is_no_noise(identifier: str) -> None:
    found = diagnose(measured(effect(identifier), 3))
    assert [f.cause for f in found.findings] == [identifier]
    assert found.noise == ()


@pytest.mark.parametrize("factor", [1 / 3, 3.0])
def test_in_orientations_too_where_no_sensor_by_itself_tells_its_noise(factor: float) -> None:
    """Eleven degrees of freedom a sensor: only all of them together tell the factor, the one that jumps among them."""
    found = diagnose(read_session(in_orientations(Wish("", hidden=True, seed=(5, 4, 1, 2)), factor).session))
    assert [(f.cause, f.sensors) for f in found.findings] == [("bias-jump", ("A5",))]
    assert [scale.factor for scale in found.noise] == pytest.approx([1 / factor], rel=0.25)


@pytest.mark.parametrize("world", [beside_gyros, in_logs])
@pytest.mark.parametrize("hidden", [False, True])
def test_a_jump_is_named_and_nothing_else_beside_gyros_and_in_rests_that_settle(
    world: Callable[[Wish], Hidden], hidden: bool
) -> None:
    found = diagnose(read_session(world(Wish("", hidden, seed=(5, 6, 1, 2))).session))
    assert [f.cause for f in found.findings] == ["bias-jump"] * hidden


def test_gyros_whose_effects_passed_for_noise_are_believed_again_beside_accelerometers_that_are_not() -> None:
    """Two kinds of sensors: half the gyros drift, and the accelerometers' errors are stated three times too large."""
    schedule = wandering(block((*accelerometers(4), *gyros(4)), 12))
    noise = np.array([3e-6] * 4 + [0.3] * 4)
    session = stated(Scene(World(schedule, truth_of(schedule)), noise).measured(1), 3.0, slice(0, 4))
    ramp = 20 * noise * np.linspace(-1, 1, len(session.readings))[:, None] * [0, 0, 0, 0, 1, -1, 0, 0]
    begun = begin(baseline_of(replace(session, readings=session.readings + ramp)), [], [cause("bias-ramp")])
    found = under_free_scale(begun, doubted(begun))
    assert found is not None
    assert [claim.kind for claim in found.noise_claims] == [ACCELEROMETER]
    assert found.baseline.unstated.tolist() == [True] * 4 + [False] * 4
    assert sorted(i for f in found.detections for i in f.best.sensors) == [4, 5]


def test_one_noisy_sensor_is_excess_noise_and_no_wrong_claim() -> None:
    found = diagnose(stated(measured(seed=3), 0.2, slice(1, 2)))
    assert [(f.cause, f.sensors) for f in found.findings] == [("excess-noise", ("A2",))]
    assert found.noise == ()


def test_some_sensors_of_too_large_errors_are_told_apart() -> None:
    """Half of them: the others' stated errors are believed."""
    found = diagnose(stated(measured(seed=3), 3.0, slice(0, 2)))
    assert not found.findings
    assert [(scale.sensors, scale.factor) for scale in found.noise] == [(("A1", "A2"), pytest.approx(1 / 3, rel=0.25))]


def test_sensors_of_too_small_errors_draw_no_other_in() -> None:
    """Believed too much, half of a block pulls what all share of a row to its own noise, which the others then show."""
    case = draw_case("none", (4001, 3, 1, 1, 0))
    session, earlier = (stated(read_session(file), 0.1, slice(0, 3)) for file in (case.session, *case.history))
    found = diagnose(session, history=[earlier])
    assert not found.findings
    assert [scale.sensors for scale in found.noise] == [("A1", "A2", "A3")]


@pytest.mark.parametrize("sensors", [slice(0, 1), slice(0, 2)])
def test_a_cause_is_named_on_a_sensor_whose_errors_are_stated_too_large(sensors: slice) -> None:
    """A2 jumps; it is one of those whose errors are wrong, or its own are right."""
    found = diagnose(stated(measured(effect("bias-jump"), 3), 3.0, sensors))
    assert [f.cause for f in found.findings] == ["bias-jump"]


@pytest.mark.parametrize("identifier", ["stand-drift", "alpha-shift"])
def test_what_is_common_is_named_beside_a_sensor_whose_errors_are_stated_too_small(identifier: str) -> None:
    """The sensor's noise, believed to be none, shows in all sensors and would pass for a course of the applied
    vector.
    """
    found = diagnose(stated(measured(effect(identifier), 3), 0.1, slice(1, 2)))
    assert {f.cause for f in found.findings} == {identifier, "excess-noise"}
    assert not found.unexplained


def repeated() -> Scene:
    """Four accelerometers, every position measured twice."""
    once = wandering(block(accelerometers(4), 12))
    twice = np.tile(np.arange(len(once.readings)), 2)
    schedule = replace(
        once,
        readings=once.readings[twice],
        standard_errors=once.standard_errors[twice],
        beta=once.beta[twice],
        flipped=once.flipped[twice],
        time=np.arange(len(twice)) * 300.0,
        temperature=once.temperature[twice],
        vibration=None,
    )
    return Scene(World(schedule, truth_of(schedule)), np.full(4, 3e-6))


def test_pure_error_is_the_scatter_of_what_repeats() -> None:
    scatter = [pure_error(baseline_of(repeated().measured(seed)), np.full(4, True)) for seed in range(8)]
    assert {s.freedom for s in scatter} == {24 * 4.0}
    assert sum(s.energy for s in scatter) / sum(s.freedom for s in scatter) == pytest.approx(1, abs=0.12)


def test_where_repeats_agree_with_the_stated_noise_misfit_is_no_noise() -> None:
    where = repeated()
    session = where.measured(1)
    beta = session.beta
    assert beta is not None
    bent = session.readings + 60 * where.noise * np.sign(np.sin(5 * beta))[:, None] * [1, -1, 1, -1]
    assert doubted(begin(baseline_of(replace(session, readings=bent)), (), ())) == ()
    assert doubted(begin(baseline_of(stated(session, 0.2)), (), ()))


@pytest.mark.slow
def test_a_course_of_the_applied_vector_is_no_wrong_claim() -> None:
    assert diagnose(measured(swaying(2e-4))).noise == ()
    assert diagnose(stated(measured(swaying(2e-4)), 0.3)).noise[0].factor == pytest.approx(1 / 0.3, rel=0.25)


def test_what_passes_for_a_shared_course_in_far_too_small_errors_is_not_searched_beside() -> None:
    """Scatter that is taken ten times too seriously looks alike on some sensors by chance."""
    sound = measured(seed=3)
    right, wrong = (begin(baseline_of(session), [], CATALOGUE) for session in (sound, stated(sound, 0.1)))
    event = shared_event(wrong)
    assert event
    assert left_claims(right, event) == ()
    assert left_claims(wrong, event)


def test_readings_without_noise_leave_the_diagnosis_standing() -> None:
    found = diagnose(stated(measured(seed=5), 1e6))
    assert not found.findings
    assert found.noise[0].factor < 1e-3


def test_repeats_that_contradict_the_stated_noise_do_not_save_it() -> None:
    found = diagnose(stated(repeated().measured(1), 0.2))
    assert not found.findings
    assert [scale.factor for scale in found.noise] == pytest.approx([5.0], rel=0.2)


@pytest.mark.parametrize(("ratio", "kept"), [(100.0, 2), (1000.0, 1)])
def test_no_cause_is_told_from_scatter_that_is_no_noise(ratio: float, kept: int) -> None:
    state = start(("bias-ramp",), effect("bias-ramp") + effect("bias-ramp", 3))
    named = tuple(candidate(state, "bias-ramp", (sensor,)) for sensor in (SENSOR, 3))
    claim = NoiseClaim(ACCELEROMETER, (SENSOR,), ratio, 20.0)
    assert len(without_names_in_no_noise(replace(state, detections=named, noise_claims=(claim,))).detections) == kept


def test_what_a_prior_in_place_of_the_switch_would_cost_is_what_the_page_says() -> None:
    """One in a hundred over a thousand candidates, a sensor of fourteen degrees of freedom."""
    spread = np.log(3) / 2
    worth = brentq(lambda dof: np.sqrt(polygamma(1, dof / 2)) / 2 - spread, 0.1, 50.0)
    tail, dof = 0.01 / 1000 / 2, 14 + worth
    known, unknown = stats.norm.isf(tail), stats.t.isf(tail, dof)
    assert worth == pytest.approx(2.5, abs=0.05)
    shown = [100 * stats.norm.sf(known - s) for s in (6, 8)] + [100 * stats.nct.sf(unknown, dof, s) for s in (6, 8)]
    assert [round(share) for share in shown] == [94, 100, 46, 89]
    page = " ".join(PAGE.read_text(encoding="utf-8").split())
    assert "strength 6 in 46 % of its sessions instead of 94 %, of strength 8 in 89 % instead of all" in page
