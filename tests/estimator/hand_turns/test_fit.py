"""Gyros turned by hand, from simulated logs of known truth."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.stats import chi2

from benchmarks.hands.study import bound, of_gyros, tried
from benchmarks.hands.world import World, simulated
from estimator import calibrate
from estimator.arrays import tangents
from estimator.hand_turns.model import ExtraNoise, moments, parts
from estimator.hand_turns.recording import RestDirections, TurnedLog
from estimator.results import HandTurns, TurnsOutcome

SHORT = World(rests=16, rest=3.0)


@cache
def calibrated(world, seed=5):
    truth = simulated(world, np.random.default_rng(seed))
    return truth, calibrate(truth.session)


@pytest.mark.parametrize("m", [3, 5])
def test_errors_are_what_the_covariance_says(m):
    many = [tried(replace(SHORT, gyros=m), seed) for seed in range(6)]
    total, count = sum(t.squared for t in many), 4 * m * len(many)
    assert chi2.ppf(1e-3, count) < total < chi2.ppf(1 - 1e-3, count)


@pytest.mark.slow
def test_variance_is_the_bound_and_intervals_hold():
    many = [tried(World(gyros=4), seed) for seed in range(40)]
    ratio = np.mean([((t.error / t.bound) ** 2).mean() for t in many])
    held = np.mean([(np.abs(t.error) <= t.reach * t.sigma).mean() for t in many])
    assert 0.8 < ratio < 1.25  # known to 0.06 from 40 logs
    assert 0.92 < held < 0.98


def test_stated_sigma_is_that_of_the_bound():
    truth, found = calibrated(SHORT)
    assert of_gyros(found)[0] == pytest.approx(bound(truth), rel=0.25)


@pytest.mark.parametrize("factor", [np.degrees(1.0), np.radians(1.0)])
def test_degrees_taken_for_radians_are_the_scale_factor(factor):
    _, found = calibrated(replace(SHORT, units=factor))
    assert [s.scale.value / factor for s in found.sensors[3:]] == pytest.approx([1.0] * 3, abs=0.1)


def test_a_lost_sign_turns_the_axis_of_its_gyro_alone():
    _, found = calibrated(replace(SHORT, signs=(1.0, -1.0, 1.0)))
    assert [s.axis[i] for i, s in enumerate(found.sensors[3:])] == pytest.approx([1, -1, 1], abs=0.01)


def test_g_sensitivity_is_found_where_there_is_one():
    truth, found = calibrated(replace(SHORT, force=1e-4))
    for i, sensor in enumerate(found.sensors[3:]):
        answer = sensor.g_sensitivity
        off = answer.value - truth.force[i]
        assert off @ np.linalg.solve(answer.covariance, off) < chi2.ppf(0.9999, 3)


def test_g_sensitivity_is_left_out_where_there_is_none():
    _, found = calibrated(SHORT)
    assert [s.g_sensitivity for s in found.sensors] == [None] * 6


def test_rests_are_found_where_none_is_labelled():
    _, labelled = calibrated(SHORT)
    _, found = calibrated(replace(SHORT, labelled=False))
    for one, other in zip(labelled.sensors[3:], found.sensors[3:], strict=True):
        assert one.scale.value == pytest.approx(other.scale.value, abs=3 * one.scale.sigma)


@pytest.mark.parametrize("late", [20, 40])
def test_gyros_that_lag_behind_one_another_give_no_scale_factors(late):
    truth, _ = calibrated(SHORT)
    readings = truth.session.readings.copy()
    readings[late:, 4] = readings[:-late, 4]
    found = calibrate(replace(truth.session, readings=readings))
    assert [s.scale.value for s in found.sensors[3:]] == [None] * 3
    assert found.hand_turns.outcome is TurnsOutcome.SCATTERED
    assert found.hand_turns.scatter > 3
    assert np.isfinite([s.bias.value for s in found.sensors[3:]]).all()


def test_a_turn_with_missing_samples_takes_no_part():
    truth, _ = calibrated(SHORT)
    readings = truth.session.readings.copy()
    readings[np.flatnonzero(truth.session.position == -1)[50:60], 3:] = np.nan
    found = calibrate(replace(truth.session, readings=readings))
    off = [(s.scale.value - truth.scale[i]) / s.scale.sigma for i, s in enumerate(found.sensors[3:])]
    assert np.abs(off).max() < 4
    assert found.hand_turns == HandTurns(TurnsOutcome.USED, 1.0, 1.0)


def test_a_turn_beyond_the_range_of_a_gyro_takes_no_part():
    truth, _ = calibrated(SHORT)
    readings = truth.session.readings.copy()
    turn = np.flatnonzero(truth.session.position == -1)[:20]
    readings[turn, 3] = 2 * np.abs(readings[:, 3]).max()
    found = calibrate(replace(truth.session, readings=readings))
    off = [(s.scale.value - truth.scale[i]) / s.scale.sigma for i, s in enumerate(found.sensors[3:])]
    assert np.abs(off).max() < 4


def test_two_gyros_keep_their_biases_alone():
    _, found = calibrated(replace(SHORT, gyros=2))
    assert [s.observable["scale"] for s in found.sensors[3:]] == [False, False]


def test_a_block_turned_about_one_axis_tells_no_scale():
    truth, _ = calibrated(SHORT)
    readings = truth.session.readings.copy()
    readings[:, 3:5] = readings[0, 3:5]
    found = calibrate(replace(truth.session, readings=readings))
    assert not any(s.observable["scale"] for s in found.sensors[3:])
    assert found.hand_turns.outcome is TurnsOutcome.UNDETERMINED


def likelihood(m=5, rests=9):
    """A log of noise alone, its rests, and a point, all without meaning."""
    rng = np.random.default_rng(1)
    N, up = 40 * rests, rng.standard_normal((rests, 3))
    start = 40 * np.arange(rests)
    moving = (np.arange(N) % 40 >= 10)[:, None]
    log = TurnedLog(
        readings=moving * np.sin(0.2 * np.arange(N)[:, None] + rng.uniform(0, 6, m)),
        force=rng.standard_normal((N, 3)), step=0.05, start=start, stop=start + 10, seen=(start, start + 10),
        whole=np.ones(rests - 1, bool), rest=rng.normal(scale=0.01, size=(rests, m)),
        rest_sigma=np.full((rests, m), 0.01), noise=np.linspace(1, 2, m) * 1e-4,
        axes=rng.standard_normal((m, 3)), latitude=None, gravity=9.81,
    )  # fmt: skip
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    return (
        log,
        RestDirections(up, tangents(up), 1e-6 * np.eye(2 * rests)),
        rng.standard_normal((m, 7)) * ([1] * 3 + [0.01] * 4),
    )


def test_the_derivative_of_the_turns_is_the_numerical_one():
    log, rests, p = likelihood()
    w, sums, noise = np.full(3, 1e-4), moments(log), ExtraNoise(np.zeros(5))

    def at(step):
        return parts(log, rests, sums, (p + step[:-3].reshape(p.shape), w + step[-3:]), noise).miss

    for i in range(38):
        h = np.zeros(38)
        h[i] = 1e-6
        # the weights W move with S, which the model leaves out: what that adds is the parities, not noise alone here
        if i >= 35 or i % 7 >= 3:
            slope = (at(h).residual - at(-h).residual) / 2e-6
            assert at(0 * h).J[:, i] == pytest.approx(slope, abs=0.05 * np.abs(slope).max())
