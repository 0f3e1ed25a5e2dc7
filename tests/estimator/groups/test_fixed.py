"""A session calibrated with effects whose size a group fixed."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import CalibrationSession, calibrate, calibrate_extended, diagnose_group
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.groups.fixed import (
    EMPIRICAL,
    FixedEffect,
    added_by,
    calibrate_with,
    fixed,
    in_one_session,
    taken_out,
)
from estimator.reading import read_session
from estimator.results import Calibration
from tests.blind.world import Effect
from tests.builders import accelerometer_block, true_sensors
from tests.estimator.groups.cases import measured, worlds

SIZE = 2.5e-5
TRUTH = Effect("beta-eccentricity", (SIZE, -SIZE))
KNOWN = FixedEffect("beta-eccentricity", (), "", (SIZE, -SIZE), (1e-9, 1e-9), None, varies=False)


@pytest.fixture(scope="module")
def pair() -> tuple[CalibrationSession, CalibrationSession]:
    """A session with an eccentric head, and the same readings without."""
    world = worlds(1)[0]
    return measured(world, [TRUTH], 5), measured(world, [], 5)


def parameters(found: Calibration) -> np.ndarray:
    return np.array([(s.scale.value, s.bias.value, *s.axis) for s in found.sensors])


def distance(one: Calibration, other: Calibration) -> float:
    """The largest difference of two calibrations, in standard uncertainties."""
    sigma = np.array([(s.scale.sigma, s.bias.sigma, *[s.axis_sigma] * 3) for s in other.sensors])
    return float(np.abs((parameters(one) - parameters(other)) / sigma).max())


def test_what_is_known_is_taken_out_of_the_readings(pair: tuple[CalibrationSession, CalibrationSession]) -> None:
    eccentric, sound = pair
    truth = calibrate(sound)
    assert distance(calibrate_with(eccentric, [KNOWN]), truth) < 0.05
    assert distance(calibrate(eccentric), truth) > 0.2


def test_what_is_not_known_of_it_is_in_the_covariance(pair: tuple[CalibrationSession, CalibrationSession]) -> None:
    eccentric = pair[0]
    unsure = replace(KNOWN, sigma=(4e-6, 4e-6))
    moved = [calibrate_with(eccentric, [replace(KNOWN, amplitude=(SIZE + d, -SIZE))]) for d in (0.0, 4e-6)]
    grown = calibrate_with(eccentric, [unsure]).covariance - calibrate_with(eccentric, [KNOWN]).covariance
    step = moved[1].sensors[0].bias.value - moved[0].sensors[0].bias.value
    assert grown[1, 1] > 0.99 * step**2
    assert np.linalg.eigvalsh(grown).min() > -1e-12 * np.abs(grown).max()


def test_of_one_cause_the_first_counts(pair: tuple[CalibrationSession, CalibrationSession]) -> None:
    eccentric = pair[0]
    twice = calibrate_with(eccentric, [KNOWN, replace(KNOWN, amplitude=(1e-3, 1e-3))])
    assert np.array_equal(parameters(twice), parameters(calibrate_with(eccentric, [KNOWN])))


def test_what_is_fitted_is_not_taken_out_too(pair: tuple[CalibrationSession, CalibrationSession]) -> None:
    eccentric, fitted = pair[0], [("beta-eccentricity", ())]
    both, alone = calibrate_with(eccentric, [KNOWN], fitted), calibrate_extended(eccentric, fitted)
    assert np.array_equal(parameters(both), parameters(alone))


def test_a_session_has_a_say_in_what_differs_every_time(pair: tuple[CalibrationSession, CalibrationSession]) -> None:
    eccentric, sound = pair
    prior = replace(KNOWN, amplitude=(0.0, 0.0), sigma=(1.0, 1.0), varies=True)
    free = calibrate_extended(eccentric, [("beta-eccentricity", ())])
    assert distance(calibrate_with(eccentric, [prior]), free) < 0.05
    narrow = replace(prior, amplitude=(SIZE, -SIZE), sigma=(1e-9, 1e-9))
    assert distance(calibrate_with(eccentric, [narrow]), calibrate(sound)) < 0.05


def test_what_a_session_cannot_have_is_left_out(pair: tuple[CalibrationSession, CalibrationSession]) -> None:
    other = replace(KNOWN, cause="cubic-nonlinearity", sensors=("B9",), kind="accelerometer", amplitude=(1e-7,))
    assert np.array_equal(parameters(calibrate_with(pair[1], [other])), parameters(calibrate(pair[1])))


def test_a_cause_on_every_sensor_is_taken_out_of_each(pair: tuple[CalibrationSession, CalibrationSession]) -> None:
    every = FixedEffect("cubic-nonlinearity", ("*",), "accelerometer", (5e-8,), (1e-12,), None, varies=False)
    each = [replace(every, sensors=(s.name,)) for s in pair[1].sensors]
    assert distance(calibrate_with(pair[1], [every]), calibrate_with(pair[1], each)) < 1e-6


def test_a_finding_is_fixed_with_the_spread_of_its_sessions() -> None:
    assert in_one_session((3.0, float("nan"), 1.0, 0.0), (4.0, 2.0)) == (5.0, 0.0, np.hypot(1.0, 2.0), 2.0)
    sessions = [measured(w, [TRUTH], 80 + k) for k, w in enumerate(worlds(6))]
    (finding,) = diagnose_group(sessions, "stand").findings
    effect = fixed(finding)
    assert (effect.cause, effect.amplitude, effect.varies) == ("beta-eccentricity", finding.amplitude, False)
    assert effect.sigma[0] >= finding.sigma[0]


WAVE = Effect("third-harmonic", (2e-4,), (1,), (0.5,))
LEARNED = FixedEffect(
    EMPIRICAL, ("A2",), "", (2e-4 * np.cos(0.5), 2e-4 * np.sin(0.5)), (1e-9, 1e-9), None, varies=False,
    words=("sin 3β", "cos 3β"),
)  # fmt: skip


def test_a_learned_term_is_taken_out_of_the_readings() -> None:
    world = worlds(1)[0]
    wavy, truth = measured(world, [WAVE], 5), calibrate(measured(world, [], 5))
    assert distance(calibrate_with(wavy, [LEARNED]), truth) < 0.05
    assert distance(calibrate(wavy), truth) > 0.2


def test_what_of_a_term_a_session_lacks_is_left_out() -> None:
    session = replace(measured(worlds(1)[0], [], 5), temperature=None)
    warm = replace(LEARNED, words=("sin 3β", "(T − T̄)"))
    alone = replace(LEARNED, words=("sin 3β",), amplitude=LEARNED.amplitude[:1], sigma=LEARNED.sigma[:1])
    assert np.array_equal(parameters(calibrate_with(session, [warm])), parameters(calibrate_with(session, [alone])))
    elsewhere = calibrate_with(session, [replace(LEARNED, sensors=("B9",))])
    assert np.array_equal(parameters(elsewhere), parameters(calibrate(session)))


def test_what_is_not_known_is_added_along_the_calibration_s_own_tangents() -> None:
    sensors = true_sensors(8)
    session = read_session(accelerometer_block(8, seed=1, sensors=sensors, positions=24))
    moves = FixedEffect("cubic-nonlinearity", ("A2",), "accelerometer", (2e-5,), (2e-6,), None, varies=False)
    baseline = baseline_of(session)
    added = added_by(baseline, [moves], ())
    assert added is not None
    without, more = taken_out(baseline, added)
    plain, found = calibrate(without).sensor("A2"), calibrate_with(session, [moves]).sensor("A2")
    frame = baseline.parameters.axis_tangents[1]
    assert np.abs(frame - found.axis_tangents).max() > 0.5
    grown = in_space(plain.axis_tangents, plain.axis_covariance) + in_space(frame, more[8:10, 8:10])
    assert in_space(found.axis_tangents, found.axis_covariance) == pytest.approx(grown, rel=1e-3, abs=1e-16)


def in_space(frame: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """(3, 3) covariance in space of turns along tangents, rad²."""
    return np.asarray(frame @ covariance @ frame.T)
