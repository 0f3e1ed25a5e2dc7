"""Requirements of every converter."""

import json

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from benchmarks.convert import FORMATS, convert
from estimator.calibration import calibrate
from estimator.errors import SessionError
from estimator.reading import read_session
from tests.service.convert.made import MADE

NAMES = [converter.name for converter in FORMATS]


@pytest.fixture(scope="module")
def recordings(tmp_path_factory):
    """The files of a made recording in each format."""
    return {name: MADE[name](tmp_path_factory.mktemp(name)) for name in NAMES}


@pytest.mark.parametrize("name", NAMES)
def test_what_it_writes_can_be_read_and_calibrated(name, recordings):
    sessions = convert(name, recordings[name])
    assert sessions
    for _, document in sessions:
        result = calibrate(read_session(json.dumps(document).encode()))
        assert result.fit.rank == result.fit.parameters
        assert all(s.observable["bias"] for s in result.sensors)


@pytest.mark.parametrize("name", NAMES)
def test_suggested_names_differ_and_have_no_folder(name, recordings):
    names = [suggested for suggested, _ in convert(name, recordings[name])]
    assert len(set(names)) == len(names)
    assert all(suggested.endswith(".json") and "/" not in suggested for suggested in names)


@pytest.mark.parametrize("name", NAMES)
def test_a_missing_file_is_named(name, recordings, tmp_path):
    first, *others = recordings[name]
    with pytest.raises(SessionError, match=first.name):
        convert(name, [tmp_path / first.name, *others])


@pytest.mark.parametrize("name", NAMES)
def test_the_wrong_number_of_files_says_which_to_name(name):
    with pytest.raises(SessionError, match=r"files: .*name "):
        convert(name, [])


@pytest.mark.parametrize("name", NAMES)
@given(content=st.binary(max_size=400))
@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_bytes_are_refused_with_the_files_name(name, content, recordings, tmp_path):
    first, *others = recordings[name]
    garbage = tmp_path / first.name
    garbage.write_bytes(content)
    with pytest.raises(SessionError, match=first.name):
        convert(name, [garbage, *others])


def outcome(name, paths):
    """The sessions, or the reason why there are none; any other error fails the test."""
    try:
        return convert(name, paths)
    except SessionError as refused:
        return refused.problems


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
@given(cut=st.floats(0, 1), byte=st.integers(0, 255))
@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_damaged_file_is_converted_or_refused(name, cut, byte, recordings, tmp_path):
    first, *others = recordings[name]
    content = bytearray(first.read_bytes())
    content[int(cut * (len(content) - 1))] = byte
    damaged = tmp_path / first.name
    damaged.write_bytes(bytes(content))
    assert outcome(name, [damaged, *others])


def test_an_unknown_format_lists_the_known_ones():
    with pytest.raises(SessionError, match="imu-tk, mpu9150-five, kth-mimu, ctu-mat, ferraris-csv"):
        convert("nmea", [])
