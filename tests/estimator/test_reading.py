"""Sessions read from good files."""

import json
import math

import numpy as np
import pytest

from estimator.calibration.calibrate import averaged
from estimator.reading import read_session
from tests import builders
from tests.builders import ARCSEC


@pytest.mark.parametrize("build", builders.EVERY)
def test_every_kind_of_session_is_read(build):
    document = build()
    session = read_session(document)
    names = [sensor["name"] for sensor in document["sensors"]]
    assert session.readings.shape == (len(document["table"][names[0]]), len(names))
    assert np.array_equal(session.readings[:, 0], document["table"][names[0]])


def test_angles_become_radians():
    session = read_session(builders.accelerometer_block(alpha_deg=30.0, positions=12))
    assert session.stand.alpha == pytest.approx(math.pi / 6)
    assert session.stand.sigma.beta == pytest.approx(ARCSEC)
    assert session.site.latitude == pytest.approx(math.radians(55.81))
    assert session.beta[1] == pytest.approx(math.pi / 6)


def test_the_flipped_run_is_marked():
    session = read_session(builders.accelerometer_block(positions=4))
    assert session.flipped.tolist() == [False] * 4 + [True] * 4


def test_a_missing_standard_error_is_nan():
    document = builders.accelerometer_block()
    del document["table"]["A2_se"]
    document["table"]["A3_se"][4] = None
    session = read_session(document)
    assert np.isnan(session.standard_errors[:, 1]).all()
    assert np.flatnonzero(np.isnan(session.standard_errors[:, 2])).tolist() == [4]


def test_what_is_not_stated_is_none_or_zero():
    document = builders.accelerometer_block()
    for key in ("started_at", "operator", "notes", "mounting"):
        del document[key]
    del document["stand"]["sigma_arcsec"]
    del document["table"]["time_s"]
    document["table"]["temperature_c"] = None
    session = read_session(document)
    assert (session.started_at, session.operator, session.time, session.temperature) == (None, "", None, None)
    assert session.stand.sigma.beta == 0
    assert np.array_equal(session.mounting, np.eye(3))


@pytest.mark.parametrize("first", [0.0, 600.0, -1e6])
@pytest.mark.parametrize("stated", [{"powered_on_at": "2026-03-01T11:20:00+03:00"}, {"time_since_power_on_s": 2400.0}])
def test_switching_on_is_known_by_the_clock_of_the_rows(stated, first):
    document = builders.accelerometer_block() | stated
    document["table"]["time_s"] = [first + t for t in document["table"]["time_s"]]
    session = read_session(document)
    assert (session.switched_on, session.time_since_power_on) == (first - 2400, 2400)


def test_without_a_clock_switching_on_counts_from_the_first_row():
    document = builders.accelerometer_block() | {"time_since_power_on_s": 0}
    del document["table"]["time_s"]
    assert read_session(document).time_since_power_on == 0


def test_when_it_was_switched_on_need_not_be_said():
    session = read_session(builders.accelerometer_block() | {"powered_on_at": None})
    assert (session.switched_on, session.time_since_power_on) == (None, None)


def test_a_log_that_is_averaged_was_switched_on_when_it_was():
    log = read_session(builders.raw_log() | {"time_since_power_on_s": 90.0})
    rows = averaged(log)
    assert rows.switched_on == log.switched_on
    assert rows.time_since_power_on > 90.0


def test_pulse_gyros_keep_their_count_time():
    session = read_session(builders.gyro_block(count_time_s=100.0))
    assert session.count_time == 100
    assert session.stand.sigma.count_time == 1e-5
    assert session.stand.sigma.meridian == pytest.approx(5 * ARCSEC)
    assert session.sensors[0].bias_repeatability == 6e-8


def test_a_mixed_block_holds_both_kinds():
    kinds = [sensor.kind for sensor in read_session(builders.mixed_block(3)).sensors]
    assert kinds == ["accelerometer"] * 3 + ["gyroscope"] * 3


def test_nominal_axes_become_exact_unit_vectors():
    document = builders.accelerometer_block(3)
    document["sensors"][0]["nominal_axis"] = [0.8165, 0.5774, 0.0]
    axis = read_session(document).sensors[0].nominal_axis
    assert np.linalg.norm(axis) == pytest.approx(1, abs=1e-15)


def test_directions_become_unit_vectors_with_unknown_rows():
    document = builders.arbitrary_orientations(direction_sigma_deg=2.0)
    for axis, value in zip("xyz", (0.0, 0.0, 9.81), strict=True):
        document["table"][f"direction_{axis}"][0] = value
        document["table"][f"direction_{axis}"][1] = None
    session = read_session(document)
    assert session.directions[0].tolist() == [0, 0, 1]
    assert np.isnan(session.directions[1]).all()
    assert session.direction_sigma == pytest.approx(math.radians(2))


@pytest.mark.parametrize(
    ("written", "read"),
    [
        ([3, 3, -1, 5], [3, 3, -1, 5]),
        ([3.0, 3.0, None, 5.0], [3, 3, -1, 5]),
        (["up", "up", None, "left"], [0, 0, -1, 1]),
        (["up", 7, -1, "up"], [0, 1, -1, 0]),
        (["3", "3", "-1", "5"], [3, 3, -1, 5]),
    ],
)
def test_position_labels(written, read):
    document = builders.arbitrary_orientations(orientations=4)
    document["table"]["position"] = written
    assert read_session(document).position.tolist() == read


def test_a_raw_log_knows_its_rate():
    session = read_session(builders.raw_log(rate_hz=250.0))
    assert session.is_raw
    assert session.sample_rate == 250
    assert np.isnan(session.standard_errors).all()


def test_a_path_bytes_and_a_dict_are_the_same(tmp_path):
    document = builders.accelerometer_block()
    path = tmp_path / "session.json"
    path.write_text(json.dumps(document), encoding="utf-8-sig")
    for source in (path, str(path), path.read_bytes()):
        assert np.array_equal(read_session(source).readings, read_session(document).readings)


def test_arrays_in_a_dict_are_columns_too():
    document = builders.accelerometer_block()
    as_arrays = {name: np.array(cells) for name, cells in document["table"].items() if name != "run"}
    session = read_session(document | {"table": document["table"] | as_arrays})
    assert np.array_equal(session.readings, read_session(document).readings)


def test_additions_of_ones_own_are_tolerated():
    document = builders.accelerometer_block() | {"laboratory": "North", "weather": {"rain": True}}
    document["table"]["humidity_percent"] = [40.0] * 24
    assert read_session(document).unit == "BA-017"
