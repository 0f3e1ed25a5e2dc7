"""Results from a recording: false alarms, detection, isolation, honest covariance, and changes that cannot be seen."""

import json
import tracemalloc
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from estimator.errors import ScheduleError
from estimator.parity import ParityAccumulator, parity_check
from estimator.parity.flight import TRANSPORT, Manoeuvre, Weather
from tests.estimator.parity.cases import STILL, biased, block, recording, scaled, tilted

RUNS = 16


def results(m, *, change=lambda true: true, runs=RUNS, motion="auto", **options):
    """Results of many blocks, each with a recording of its own."""
    found = []
    for seed in range(runs):
        true, reference = block(m, seed)
        found.append(parity_check(recording(change(true), seed, seconds=120.0, **options), reference, motion=motion))
    return found


@cache
def unchanged():
    """Results for six sensors that nothing happened to, said to move in any way."""
    return results(6, motion="any", runs=24)


@pytest.mark.slow
@pytest.mark.parametrize("m", [4, 6, 9])
def test_an_unchanged_block_is_called_changed_no_more_often_than_stated(m):
    alarms = sum(r.detected for r in results(m))
    assert alarms <= 2, "one in a hundred is stated: more than 2 of 16 has a probability of 0.05 %"


@pytest.mark.slow
def test_slow_noise_raises_no_alarms():
    slow = Weather(wander=3e-4, wander_time=20.0)
    assert sum(r.detected for r in results(6, weather=slow)) <= 2


def test_rest_raises_no_alarms():
    assert sum(r.detected for r in results(6, manoeuvres=STILL)) <= 2


@pytest.mark.slow
def test_stated_sigmas_are_honest():
    """The sensors are said to sit in one point, as they do; a stated place leaves half a millimetre."""
    found = unchanged()
    z = np.array([s.bias.size / s.bias.sigma for r in found for s in r.sensors])
    assert 0.8 < np.sqrt(np.mean(z**2)) < 1.2


def test_p_values_of_unchanged_blocks_are_spread():
    p = np.array([r.p_value for r in unchanged()])
    assert 0.2 < np.mean(p < 0.5) < 0.7


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "change"),
    [
        ("bias", lambda true: biased(true, 2, 1e-3)),
        ("scale", lambda true: scaled(true, 2, 3e-4)),
        ("axis", lambda true: tilted(true, 2, 3e-4 * np.cross(true.axes[2], [0.0, 0.0, 1.0]))),
    ],
)
def test_a_change_is_attributed_to_its_sensor(kind, change):
    found = results(6, change=change, runs=12)
    assert all(r.detected for r in found)
    assert sum(r.isolated == "A3" for r in found) >= 11
    assert sum(kind in [c.kind for c in r.candidates] for r in found) >= 11


@pytest.mark.slow
def test_the_amplitude_is_found_within_its_sigma():
    found = results(6, change=lambda true: biased(true, 2, 1e-3), runs=40, motion="any")
    z = np.array([(r.sensor("A3").bias.size - 1e-3) / r.sensor("A3").bias.sigma for r in found])
    assert 0.7 < np.sqrt(np.mean(z**2)) < 1.3


@pytest.mark.slow
def test_a_change_of_the_detectable_size_is_usually_detected():
    caught = 0
    for seed in range(20):
        true, reference = block(6, seed)
        limit = parity_check(recording(true, seed, seconds=120.0), reference).sensor("A3").bias.detectable
        caught += parity_check(recording(biased(true, 2, limit), seed + 500, seconds=120.0), reference).detected
    assert caught >= 17


def test_other_sensors_are_judged_without_the_isolated_one():
    true, reference = block(6)
    found = parity_check(recording(biased(true, 2, 5e-3)), reference)
    others = [s for s in found.sensors if s.name != "A3"]
    assert found.explained
    assert max(abs(s.bias.size / s.bias.sigma) for s in others) < 4


def test_two_changed_sensors_are_not_explained_by_one():
    true, reference = block(8)
    found = parity_check(recording(scaled(biased(true, 2, 1e-2), 5, 2e-3)), reference)
    assert found.detected
    assert not found.explained


def test_a_common_bias_a_turn_and_a_stretch_leave_no_trace():
    true, reference = block(6)
    turn = Rotation.from_rotvec([1e-3, -2e-3, 5e-4]).as_matrix()
    gone = replace(true, bias=true.bias + true.axes @ [0.01, -0.02, 0.03], axes=true.axes @ turn.T)
    assert not parity_check(recording(gone, 1), reference).detected
    assert not parity_check(recording(replace(true, scale=1.001 * true.scale), 1), reference).detected


def test_the_share_that_shows_is_one_less_the_leverage():
    true, reference = block(6)
    found = parity_check(recording(true), reference)
    axes = np.stack([s.axis for s in reference.sensors])
    leverage = np.diagonal(axes @ np.linalg.inv(axes.T @ axes) @ axes.T)
    assert [s.visible_share for s in found.sensors] == pytest.approx(1 - leverage)
    assert sum(s.visible_share for s in found.sensors) == pytest.approx(3)


def test_four_sensors_detect_and_never_name_a_bias():
    true, reference = block(4)
    found = parity_check(recording(biased(true, 1, 5e-3)), reference)
    assert found.detected
    assert found.isolated is None
    assert all(s.bias.isolable is None for s in found.sensors)


def test_at_one_orientation_bias_and_scale_are_not_told_apart():
    true, reference = block(6)
    found = parity_check(recording(biased(true, 2, 5e-3), manoeuvres=STILL), reference)
    assert not found.complete
    assert found.isolated == "A3"
    assert {"bias", "scale"} <= {c.kind for c in found.candidates}


def test_a_transport_shows_enough_when_it_slips():
    true, reference = block(6)
    assert parity_check(recording(true, manoeuvres=TRANSPORT), reference).complete


def test_memory_does_not_grow_with_the_recording():
    true, reference = block(6)
    flight = recording(true, seconds=200.0, rate=10.0)
    stream = ParityAccumulator("T-1", flight.sensors, reference, sample_rate=2.0)
    tracemalloc.start()
    peaks = []
    for _ in range(2):
        for _ in range(40):
            stream.add(flight.readings)
        peaks.append(tracemalloc.get_traced_memory()[1])
    tracemalloc.stop()
    assert peaks[1] < 1.2 * peaks[0] < 20e6
    assert stream.result().duration == pytest.approx(80_000.0)


def test_a_stream_gives_what_the_whole_gives():
    true, reference = block(6)
    flight = recording(true, seconds=150.0)
    stream = ParityAccumulator("T-1", flight.sensors, reference, sample_rate=20.0, site=flight.site)
    for part in np.array_split(flight.readings, 17):
        stream.add(part)
    assert stream.result().chi2 == pytest.approx(parity_check(flight, reference).chi2, rel=1e-9)


def test_a_briefly_saturated_channel_costs_its_blocks_only():
    true, reference = block(6)
    flight = recording(true, seconds=300.0)
    limit = np.quantile(flight.readings[:, 1], 0.97)
    clipped = flight.readings.copy()
    clipped[:, 1] = np.minimum(clipped[:, 1], limit)
    found = parity_check(replace(flight, readings=clipped), reference)
    assert found.saturated == ("A2",)
    assert found.left_out["saturated"] > 5
    assert not found.detected


def test_a_moving_recording_given_as_still_is_refused():
    true, reference = block(6)
    rolling = (Manoeuvre(12.0, roll=2 * np.pi, slow_roll=True),)
    flight = recording(true, seconds=120.0, manoeuvres=rolling, weather=Weather(vibration=0.0))
    with pytest.raises(ScheduleError, match="of 120 blocks are at rest"):
        parity_check(flight, reference, motion="still")


def test_a_short_recording_is_refused():
    true, reference = block(6)
    with pytest.raises(ScheduleError, match="holds 5 blocks of one second"):
        parity_check(recording(true, seconds=5.0), reference)


def test_the_result_is_plain_json():
    true, reference = block(6)
    document = parity_check(recording(biased(true, 0, 1e-2)), reference).to_dict()
    assert json.loads(json.dumps(document, allow_nan=False))["format"] == "imu-parity/1"
