"""Raw logs: where the block stood still, the means there, and honest standard errors."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from estimator.calibration.free import calibrate_free, residual_per_freedom
from estimator.errors import ScheduleError
from estimator.reading import read_session
from estimator.session import (
    ACCELEROMETER,
    ARBITRARY_ORIENTATIONS,
    TWO_AXIS_STAND,
    CalibrationSession,
    Sensor,
    Site,
    Stand,
)
from estimator.static import Intervals, average, averaged, labelled, mean_errors
from tests.builders import raw_log

RATE = 100.0
G = 9.81
NOISE = 0.02
SCALE = np.array([1.01, 0.98, 1.02])
BIAS = np.array([0.1, -0.2, 0.05])


def raw(readings, **changes):
    sensors = tuple(Sensor(f"A{i + 1}", ACCELEROMETER, np.eye(3)[i], 1.0, "m/s²") for i in range(3))
    session = CalibrationSession(
        unit="T-1",
        block=ACCELEROMETER,
        programme=ARBITRARY_ORIENTATIONS,
        sensors=sensors,
        readings=readings,
        standard_errors=np.full_like(readings, np.nan),
        site=Site(gravity=G),
        sample_rate=RATE,
    )
    return replace(session, **changes)


def tumble(poses=20, rest=5.0, turn=2.0, seed=0):
    """A log of a triad: rest, turn by hand, rest …; the samples and where each rest is (n, 2)."""
    rng = np.random.default_rng(seed)
    d = rng.standard_normal((poses, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    still, moving = int(rest * RATE), int(turn * RATE)
    pieces, places, at = [], [], 0
    for k in range(poses):
        blend = np.linspace(0, 1, moving)[:, None]
        way = (1 - blend) * d[k] + blend * d[(k + 1) % poses] + 0.3 * rng.standard_normal((moving, 3))
        pieces += [np.tile(d[k], (still, 1)), way]
        places.append((at, at + still))
        at += still + moving
    motion = np.vstack(pieces)
    return SCALE * (G * motion + BIAS) + NOISE * rng.standard_normal(motion.shape), np.array(places)


def test_every_rest_is_found_and_nothing_of_the_turns():
    log, places = tumble()
    found = average(raw(log), residual_per_freedom)
    assert len(found.readings) == len(places)
    middle = places.mean(axis=1) / RATE
    np.testing.assert_allclose(found.time, middle, atol=0.5)
    assert not found.is_raw


def test_a_raw_log_calibrates():
    result = calibrate_free(average(raw(tumble()[0]), residual_per_freedom), quadratic=False)
    for i, sensor in enumerate(result.sensors):
        assert sensor.scale.value == pytest.approx(SCALE[i], abs=4 * sensor.scale.sigma)
        assert sensor.bias.value == pytest.approx(BIAS[i], abs=4 * sensor.bias.sigma)
    assert result.fit.p_value > 1e-3


def test_raw_counts_need_no_other_threshold():
    log, places = tumble()
    sensors = tuple(replace(s, nominal_scale=415.0) for s in raw(log).sensors)
    counts = raw(np.round(415 * log + 32768), sensors=sensors)
    assert len(average(counts, residual_per_freedom).readings) == len(places)


def test_a_log_that_never_rests_is_refused_with_advice():
    noise = np.random.default_rng(0).standard_normal((3000, 3))
    with pytest.raises(ScheduleError, match=r"still for .* fewer than 4 times; rest longer"):
        average(raw(noise * np.linspace(1, 9, 3000)[:, None]), residual_per_freedom)


def test_a_log_shorter_than_a_window_is_refused():
    with pytest.raises(ScheduleError, match=r"still for .* fewer than 4 times"):
        average(raw(np.zeros((5, 3))), residual_per_freedom)


def test_labelled_positions_are_trimmed_runs_of_one_label():
    labels = np.repeat([-1, 3, -1, 4, 3], [50, 100, 50, 200, 100])
    found = labelled(labels)
    assert found.start.tolist() == [55, 210, 405]
    assert found.stop.tolist() == [145, 390, 495]


def test_a_log_without_labelled_samples_is_refused():
    with pytest.raises(ScheduleError, match="no sample belongs to a position"):
        labelled(np.full(10, -1))


def test_labels_that_follow_each_other_separate_positions():
    log, places = tumble(poses=6)
    position = np.full(len(log), -1)
    for k, (start, stop) in enumerate(places):
        position[start:stop] = k
    session = average(raw(log, position=position, temperature=np.linspace(20, 26, len(log))), residual_per_freedom)
    assert session.position.tolist() == [0, 1, 2, 3, 4, 5]
    np.testing.assert_allclose(session.readings[2], log[slice(*places[2])].mean(axis=0), atol=5e-3)
    assert session.temperature[0] == pytest.approx(20 + 6 * 250 / len(log), abs=0.01)


def test_a_stands_log_keeps_run_and_beta_of_each_position():
    beta = np.repeat([0.0, 1.0, 0.0], 500)
    flipped = np.repeat([False, False, True], 500)
    log = np.random.default_rng(0).normal(size=(1500, 3))
    stand = raw(log, programme=TWO_AXIS_STAND, stand=Stand("S", alpha=0.7), beta=beta, flipped=flipped)
    session = average(stand, residual_per_freedom)
    assert session.beta.tolist() == [0.0, 1.0, 0.0]
    assert session.flipped.tolist() == [False, False, True]


def test_standard_errors_of_white_noise_are_sigma_over_root_n():
    log = np.random.default_rng(0).normal(size=(50 * 500, 1))
    places = Intervals(np.arange(0, 25000, 500), np.arange(500, 25500, 500))
    np.testing.assert_allclose(mean_errors(log, places).alone, 1 / np.sqrt(500), rtol=0.15)


def test_standard_errors_respect_correlated_noise():
    white = np.random.default_rng(0).normal(size=(100 * 1000, 1))
    log = lfilter([1.0], [1.0, -0.9], white, axis=0)
    places = Intervals(np.arange(0, 100000, 1000), np.arange(1000, 101000, 1000))
    scatter = places.means(log).std()
    assert mean_errors(log, places).alone[0, 0] == pytest.approx(scatter, rel=0.25)
    assert log.std() / np.sqrt(1000) < 0.3 * scatter


def test_single_samples_have_no_standard_error():
    session = averaged(raw(np.ones((3, 3))), Intervals(np.arange(3), np.arange(1, 4)))
    assert np.isnan(session.standard_errors).all()


def test_the_variance_within_each_rest_is_kept_at_the_input():
    document = raw_log(3, orientations=12, still=400, noise=1e-3)
    at = np.array(document["table"]["position"])
    shaken = (at == 3) | (at == 7)
    shake = 0.2 * np.sqrt(2) * np.sin(np.arange(len(at)) * 2.1)
    document["table"]["A1"] = (np.array(document["table"]["A1"]) + 0.12 * shaken * shake).tolist()
    found = average(read_session(document), residual_per_freedom).vibration
    np.testing.assert_allclose(found[[3, 7], 0], 0.2**2, rtol=0.02)
    np.testing.assert_allclose(found[[3, 7], 1], 1e-6, rtol=0.5)
    np.testing.assert_allclose(np.delete(found[:, 0], [3, 7]), 1e-6, rtol=0.5)


def wandering(rests, seconds, time, size, rng):
    """A log whose zero wanders exponentially correlated over ``time`` s, ``size`` times its white noise; its rests."""
    n, decay = int(seconds * RATE), np.exp(-1 / (time * RATE))
    start = np.arange(rests) * (n + 1000)
    drawn = rng.standard_normal((start[-1] + n + 1000, 3))
    wander = lfilter([np.sqrt(1 - decay**2)], [1, -decay], drawn, axis=0)[1000:]
    return rng.standard_normal(wander.shape) + size * wander, Intervals(start, start + n)


@pytest.mark.slow
@pytest.mark.parametrize(("seconds", "time"), [(5.0, 2.0), (10.0, 2.0), (5.0, 0.5)])
def test_means_of_a_zero_that_wanders_within_the_rest_are_covered(seconds, time):
    """The true mean is 0; 20 logs of 20 rests."""
    inside = []
    for seed in range(20):
        log, places = wandering(20, seconds, time, 0.3, np.random.default_rng(seed))
        inside.append(np.mean(np.abs(places.means(log)) < 1.96 * mean_errors(log, places).alone))
    assert 0.92 <= np.mean(inside) <= 0.985


def test_white_noise_is_not_taken_for_a_wandering_zero():
    ratios = []
    for seed in range(20):
        log, places = wandering(20, 5.0, 1.0, 0.0, np.random.default_rng(seed))
        ratios.append(mean_errors(log, places).alone.mean() * np.sqrt(500))
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.04)


def test_a_mean_is_never_better_than_its_independent_samples():
    """Rests whose block means happen to agree."""
    samples = np.tile([1.0, -1.0], 800)[:, None]
    places = Intervals(np.arange(0, 1600, 160), np.arange(160, 1760, 160))
    assert (mean_errors(samples, places).alone >= 0.999 / np.sqrt(160)).all()


def test_a_restless_interval_keeps_its_own_error():
    log = np.random.default_rng(4).standard_normal((50 * 500, 2))
    log[5000:5500] *= 20
    places = Intervals(np.arange(0, 25000, 500), np.arange(500, 25500, 500))
    found = mean_errors(log, places).alone[:, 0] * np.sqrt(500)
    assert found[10] == pytest.approx(20.0, rel=0.4)
    assert np.delete(found, 10) == pytest.approx(np.ones(49), rel=0.1)


@pytest.mark.parametrize(("count_time", "counts"), [(1 / RATE, [100.0, 200.0]), (0.5 / RATE, None), (None, None)])
def test_counts_without_gaps_between_them_say_how_many_were_averaged(count_time, counts):
    session = averaged(
        raw(np.ones((300, 3)), count_time=count_time), Intervals(np.array([0, 100]), np.array([100, 300]))
    )
    assert (None if session.counts_averaged is None else session.counts_averaged.tolist()) == counts
