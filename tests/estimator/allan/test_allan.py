"""Terms of noise at rest: sizes and intervals against known truth, degrees of freedom against published ones."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.allan import Rests, allan_terms, rests_of
from estimator.allan.model import model_of
from estimator.allan.results import BlockNoise, SensorNoise, interval_of
from estimator.allan.variance import variances
from estimator.calibration import calibrate
from estimator.reading import read_session
from estimator.session import IN_SERVICE
from tests import builders
from tests.estimator.allan.noises import Array, noise

INTERVAL = 0.01
SENSOR = read_session(builders.raw_log()).sensors[0]


def found(*rests: Array) -> BlockNoise:
    """Noise of channels (n, m) at rest."""
    sensors = tuple(replace(SENSOR, name=f"A{i}") for i in range(rests[0].shape[1]))
    result = allan_terms(Rests(sensors, rests, INTERVAL))
    assert result is not None
    return result


def channels(count: int, n: int, seed: int, **sizes: float) -> Array:
    rng = np.random.default_rng(seed)
    return np.column_stack([noise(n, INTERVAL, rng, **sizes) for _ in range(count)])


def covered(sensors: tuple[SensorNoise, ...], name: str, truth: float) -> tuple[int, int]:
    """Number of sensors in which the term is decided, and number of these whose interval holds the truth."""
    intervals = [interval for s in sensors if (interval := s.term(name).interval()) is not None]
    return len(intervals), sum(low <= truth <= high for low, high in intervals)


def test_the_variance_is_the_one_of_its_definition() -> None:
    y = channels(1, 64, 1, white=1.0)
    seen = variances([y], INTERVAL)
    assert seen is not None
    means = np.convolve(y[:, 0], np.ones(4) / 4, "valid")
    assert seen.value[2, 0] == pytest.approx(np.mean((means[4:] - means[:-4]) ** 2) / 2)


@pytest.mark.parametrize(("term", "factor", "share"), [(1, 1, 2 / 3), (1, 64, 1.5 / 64), (3, 64, 1 / 64)])
def test_the_degrees_of_freedom_are_those_of_the_literature(term: int, factor: int, share: float) -> None:
    """NIST SP 1065, table 5, for a long record: white and random walk frequency noise, per sample."""
    n = 65_536
    seen = variances([np.random.default_rng(1).standard_normal((n, 1))], 1.0)
    assert seen is not None
    model, place = model_of(seen), int(np.log2(factor))
    variance = model.products[term, term, place, place]
    assert 2 * model.shapes[place, term] ** 2 / variance == pytest.approx(share * n, rel=0.08)


def test_terms_of_long_records_lie_in_their_intervals() -> None:
    sensors = found(channels(12, 200_000, 2, white=1.0, flicker=0.5)).sensors
    for name, truth in (("white-noise", 1.0), ("bias-instability", 0.5)):
        decided, held = covered(sensors, name, truth)
        assert decided == 12
        assert held >= 9, "of 12, fewer than that once in two thousand times at 95 %"


def test_random_walk_and_quantisation_lie_in_their_intervals() -> None:
    sensors = found(channels(12, 200_000, 3, white=1.0, walk=0.2, rounded=0.05)).sensors
    for name, truth in (("random-walk", 0.2), ("quantisation", 0.05)):
        decided, held = covered(sensors, name, truth)
        assert decided >= 11
        assert held >= decided - 3


def test_white_noise_alone_is_called_nothing_else() -> None:
    sensors = found(channels(100, 20_000, 4, white=1.0)).sensors
    others = [t.value for s in sensors for t in s.terms if t.name != "white-noise" and t.value is not None]
    assert len(others) <= 3, "fewer than one record of a hundred, and room for chance"
    assert covered(sensors, "white-noise", 1.0)[1] >= 89


def test_many_short_rests_tell_the_white_noise_and_what_else_there_is_at_most() -> None:
    y = channels(1, 20_000, 5, white=1.0, flicker=0.2)
    sensor = found(*np.split(y, 20)).sensors[0]
    white, instability = sensor.term("white-noise"), sensor.term("bias-instability")
    assert white.value == pytest.approx(1.0, rel=0.05)
    assert instability.value is None
    assert instability.most is not None
    assert instability.most > 0.2


def test_a_filter_at_short_times_is_left_out() -> None:
    y = np.apply_along_axis(np.convolve, 0, channels(1, 100_000, 6, white=1.0), np.ones(4) / 4, "valid")
    sensor = found(y).sensors[0]
    assert sensor.holds is not None
    assert sensor.holds[0] > INTERVAL
    assert sensor.term("white-noise").value == pytest.approx(1.0, rel=0.05)


def test_a_vibration_is_no_noise_of_the_four() -> None:
    time = INTERVAL * np.arange(20_000)[:, None]
    sensor = found(channels(1, 20_000, 7, white=0.01) + np.sin(2 * np.pi * 0.31 * time)).sensors[0]
    decided = [term.name for term in sensor.terms if term.value is not None]
    assert sensor.holds is None or sensor.holds[1] - sensor.holds[0] < 20, decided


def test_a_channel_that_never_changes_decides_nothing() -> None:
    assert all(term.value is None for term in found(np.zeros((4000, 1))).sensors[0].terms)


def test_an_interval_is_that_of_chi_squared() -> None:
    """ν = 10: 10/20.483 and 10/3.247 of the square, as every table has them."""
    low, high = interval_of(1.0, (1 / 20) ** 0.5)
    assert (low**2, high**2) == pytest.approx((0.4882, 3.0798), rel=1e-3)


def test_written_and_read_it_is_the_same() -> None:
    one = found(channels(2, 4000, 8, white=1.0))
    assert BlockNoise.from_dict(one.to_dict()).to_dict() == one.to_dict()


@pytest.mark.parametrize("labelled", [True, False])
def test_the_rests_of_a_raw_log_tell_its_noise(labelled: bool) -> None:
    session = read_session(builders.raw_log(still=600, noise=1e-3, labelled=labelled))
    rests = rests_of(session)
    assert rests is not None
    result = allan_terms(rests)
    assert result is not None
    assert (result.rests, len(result.sensors)) == (12, 3)
    for sensor in result.sensors:
        assert sensor.term("white-noise").value == pytest.approx(1e-3 * INTERVAL**0.5, rel=0.1)


def test_in_service_only_what_has_the_size_of_gravity_is_a_rest() -> None:
    session = read_session(builders.raw_log(still=600))
    known = calibrate(session)
    flown = replace(session, programme=IN_SERVICE, position=None)
    assert rests_of(flown) is None, "without a calibration nothing is known to be at rest"
    still = rests_of(flown, known)
    assert still is not None
    assert len(still.readings) == 12
    shaken = replace(flown, readings=1.1 * flown.readings)
    assert rests_of(shaken, known) is None


def test_in_service_what_shakes_is_no_rest() -> None:
    """It shakes on the sum of its axes by 0.25 m/s², twice a second: steady, and of gravity's size on average."""
    session = read_session(builders.raw_log(still=600))
    flown = replace(session, programme=IN_SERVICE, position=None)
    shake = 0.25 * np.sin(2 * np.pi * 2.0 * INTERVAL * np.arange(len(flown.readings)))
    scales = np.array([sensor.nominal_scale for sensor in flown.sensors])
    shaken = replace(flown, readings=flown.readings + np.outer(shake, scales))
    assert rests_of(shaken, calibrate(session)) is None


def test_an_averaged_session_holds_no_rests() -> None:
    assert rests_of(read_session(builders.accelerometer_block())) is None
