"""Problems of bad session files: every fault is reported, with its field and row and a remedy."""

import json

import numpy as np
import pytest

from estimator.errors import FormatError, ScheduleError, SessionError
from estimator.reading import read_session
from tests import builders

STAND = builders.accelerometer_block
GYRO = builders.gyro_block
FREE = builders.arbitrary_orientations
LOG = builders.raw_log


def problems_of(source):
    with pytest.raises(SessionError) as caught:
        read_session(source)
    return caught.value.problems


def put(document, path, value):
    """Set one value by its path, or delete it where the value is ``...``."""
    *way, last = path
    for key in way:
        document = document[key]
    if value is ...:
        del document[last]
    else:
        document[last] = value


FAULTS = [
    # build, what is written where, field of the problem, row, words of the message
    (STAND, ["format"], "imu-session/2", "format", None, "imu-session/1"),
    (STAND, ["format"], ..., "format", None, "missing"),
    (STAND, ["unit"], " ", "unit", None, "empty"),
    (STAND, ["unit"], 17, "unit", None, "text in quotes"),
    (STAND, ["unit"], "a\x00b", "unit", None, "control characters"),
    (STAND, ["unit"], "\ud800", "unit", None, "control characters"),
    (STAND, ["block"], "magnetometer", "block", None, "accelerometer, gyroscope"),
    (STAND, ["programme"], "two-axis", "programme", None, "two-axis-stand"),
    (GYRO, ["counter"], "running", "counter", None, "free-running"),
    (STAND, ["counter"], "reset", "counter", None, "count_time_s is missing"),
    (STAND, ["sensors", 0, "position_m"], [0.1, 0.2], "sensors[1].position_m", None, "three components in m"),
    (STAND, ["sensors", 0, "position_m"], [0, 0, 300], "sensors[1].position_m[3]", None, "from -100 to 100 m"),
    (STAND, ["programm"], "x", "programm", None, "did you mean programme"),
    (STAND, ["alpha_deg"], 40.0, "alpha_deg", None, "belongs in stand"),
    (STAND, ["started_at"], "2026-03-01T09:00:00", "started_at", None, "Z for UTC"),
    (STAND, ["started_at"], "yesterday", "started_at", None, "2026-03-01T09:00:00Z"),
    (STAND, ["started_at"], "0001-01-01T00:00:00+23:00", "started_at", None, "year 1"),
    (STAND, ["powered_on_at"], "2026-03-01T08:20:00", "powered_on_at", None, "Z for UTC"),
    (STAND, ["powered_on_at"], "an hour before", "powered_on_at", None, "2026-03-01T09:00:00Z"),
    (STAND, ["powered_on_at"], "2026-03-01T09:00:01Z", "powered_on_at", None, "later than started_at"),
    (STAND, ["powered_on_at"], "2025-03-01T09:00:00Z", "powered_on_at", None, "more than 185 days"),
    (STAND, ["powered_on_at"], 2400, "powered_on_at", None, "text in quotes"),
    (STAND, ["powered_on"], "2026-03-01T08:20:00Z", "powered_on", None, "did you mean powered_on_at"),
    (STAND, ["time_since_power_on_s"], -1, "time_since_power_on_s", None, "from 0"),
    (STAND, ["time_since_power_on_s"], float("nan"), "time_since_power_on_s", None, "nan"),
    (STAND, ["time_since_power_on_s"], 1e9, "time_since_power_on_s", None, "1.6e+07 s"),
    (STAND, ["time_since_power_on_s"], "40 min", "time_since_power_on_s", None, "write a number"),
    (STAND, ["time_since_power_on_min"], 40, "time_since_power_on_min", None, "time_since_power_on_s"),
    (STAND, ["notes"], ["a"], "notes", None, "text in quotes"),
    (STAND, ["site", "latitude_deg"], 91, "site.latitude_deg", None, "from -90 to 90"),
    (STAND, ["site", "latitude_deg"], "55.8", "site.latitude_deg", None, "without quotes"),
    (STAND, ["site", "latitude_deg"], True, "site.latitude_deg", None, "is true"),
    (STAND, ["site", "latitude_rad"], 0.97, "site.latitude_rad", None, "latitude_deg"),
    (STAND, ["site", "height_m"], 9001, "site.height_m", None, "9000"),
    (STAND, ["site", "gravity_m_s2"], 981.5, "site.gravity_m_s2", None, "9.7 to 9.9"),
    (STAND, ["site"], ..., "site.gravity_m_s2", None, "latitude_deg"),
    (STAND, ["site"], [1], "site", None, "object"),
    (GYRO, ["site", "latitude_deg"], ..., "site.latitude_deg", None, "Earth"),
    (STAND, ["stand"], ..., "stand", None, "missing"),
    (STAND, ["stand", "id"], ..., "stand.id", None, "name"),
    (STAND, ["stand", "alpha_deg"], 0, "stand.alpha_deg", None, "strictly between"),
    (STAND, ["stand", "alpha_deg"], 90.0, "stand.alpha_deg", None, "strictly between"),
    (STAND, ["stand", "alpha_deg"], -120, "stand.alpha_deg", None, "-90 to 90"),
    (STAND, ["stand", "alpha_deg"], ..., "stand.alpha_deg", None, "missing"),
    (STAND, ["stand", "alpha_rad"], 0.7, "stand.alpha_rad", None, "alpha_deg"),
    (GYRO, ["stand", "chi_deg"], ..., "stand.chi_deg", None, "missing"),
    (GYRO, ["count_time_s"], ..., "count_time_s", None, "add the count time"),
    (GYRO, ["count_time_s"], 0, "count_time_s", None, "above 0"),
    (STAND, ["count_time_s"], 100.0, "count_time_s", None, "gyroscopes"),
    (STAND, ["stand", "sigma_arcsec", "beta"], -1, "stand.sigma_arcsec.beta", None, "from 0"),
    (STAND, ["stand", "sigma_arcsec", "betta"], 1, "stand.sigma_arcsec.betta", None, "did you mean beta"),
    (STAND, ["stand", "sigma_count_time_s"], -1, "stand.sigma_count_time_s", None, "from 0"),
    (STAND, ["mounting"], [[1, 0, 0], [0, 1, 0], [0, 0, -1]], "mounting", None, "rotation"),
    (STAND, ["mounting"], [[1, 0, 0], [0, 1, 0]], "mounting", None, "three rows"),
    (STAND, ["mounting", 1], [0, "1", 0], "mounting[2][2]", None, "without quotes"),
    (STAND, ["sensors"], ..., "sensors", None, "missing"),
    (STAND, ["sensors"], {}, "sensors", None, "list"),
    (STAND, ["sensors", 1], 5, "sensors[2]", None, "object"),
    (STAND, ["sensors", 1, "name"], "A1", "sensors[2].name", None, "sensors[1]"),
    (STAND, ["sensors", 1, "name"], "A1_se", "sensors[2].name", None, "another column"),
    (STAND, ["sensors", 1, "name"], "run", "sensors[2].name", None, "another column"),
    (STAND, ["sensors", 1, "kind"], "compass", "sensors[2].kind", None, "gyroscope"),
    (STAND, ["sensors", 1, "nominal_axis"], [0, 0, 0], "sensors[2].nominal_axis", None, "length zero"),
    (STAND, ["sensors", 1, "nominal_axis"], [0, 1, 1], "sensors[2].nominal_axis", None, "unit vector"),
    (STAND, ["sensors", 1, "nominal_axis"], [0, 1e308, 0], "sensors[2].nominal_axis[2]", None, "from -2 to 2"),
    (STAND, ["sensors", 1, "nominal_axis"], [0, 1], "sensors[2].nominal_axis", None, "three components"),
    (STAND, ["sensors", 1, "nominal_axis"], ..., "sensors[2].nominal_axis", None, "missing"),
    (STAND, ["sensors", 1, "nominal_scale"], 0, "sensors[2].nominal_scale", None, "above 0"),
    (STAND, ["sensors", 1, "nominal_scale"], -0.1, "sensors[2].nominal_scale", None, "above 0"),
    (STAND, ["sensors", 1, "reading_unit"], "", "sensors[2].reading_unit", None, "for instance V"),
    (STAND, ["sensors", 1, "reading_unit"], ..., "sensors[2].reading_unit", None, "missing"),
    (STAND, ["sensors", 1, "bias_repeatability_m_s2"], -1, "sensors[2].bias_repeatability_m_s2", None, "from 0"),
    (STAND, ["sensors", 1, "bias_repeatability_rad_s"], 1e-8, "sensors[2].bias_repeatability_rad_s", None, "m_s2"),
    (STAND, ["sensors", 1, "bias_repeatability_ug"], 10, "sensors[2].bias_repeatability_ug", None, "m_s2"),
    (STAND, ["table"], ..., "table", None, "missing"),
    (STAND, ["table"], [], "table", None, "a list of 0"),
    (STAND, ["table"], {}, "table", None, "no rows"),
    (STAND, ["table", "run"], ..., "run", None, "missing"),
    (STAND, ["table", "run", 6], "reversed", "run", 7, "direct or flipped"),
    (STAND, ["table", "run", 6], ["direct"], "run", 7, "direct or flipped"),
    (STAND, ["table", "beta_deg"], ..., "beta_deg", None, "missing"),
    (STAND, ["table", "beta_rad"], [0.0] * 24, "beta_rad", None, "beta_deg"),
    (STAND, ["table", "time_ms"], [0.0] * 24, "time_ms", None, "time_s"),
    (STAND, ["table", "beta_deg", 3], None, "beta_deg", 4, "missing"),
    (STAND, ["table", "beta_deg", 3], 999, "beta_deg", 4, "is 999; must be from -720 to 720 degrees"),
    (STAND, ["table", "time_s", 8], 400.0, "time_s", 9, "split the file there"),
    (STAND, ["table", "temperature_c", 2], 293.15, "temperature_c", 3, "from -100 to 200"),
    (STAND, ["table", "A3"], ..., "A3", None, "missing"),
    (STAND, ["table", "A3"], 0.7, "A3", None, "must be a list"),
    (STAND, ["table", "A3"], [0.7] * 23, "A3", None, "23 values where the other columns have 24"),
    (STAND, ["table", "A3", 4], float("nan"), "A3", 5, "nan"),
    (STAND, ["table", "A3", 4], float("-inf"), "A3", 5, "-inf"),
    (STAND, ["table", "A3", 4], 1e308, "A3", 5, "from -1e+20 to 1e+20"),
    (STAND, ["table", "A3", 4], 10**400, "A3", 5, "from -1e+20 to 1e+20"),
    (STAND, ["table", "A3", 4], "0.7", "A3", 5, "without quotes"),
    (STAND, ["table", "A3", 4], False, "A3", 5, "is false"),
    (STAND, ["table", "A3", 4], [0.7], "A3", 5, "a list of 1"),
    (STAND, ["table", "A3", 4], None, "A3", 5, "missing"),
    (STAND, ["table", "A3_se", 4], -3e-6, "A3_se", 5, "above 0"),
    (STAND, ["table", "A3_se", 4], 0, "A3_se", 5, "above 0"),
    (STAND, ["table", "A3_se", 4], float("nan"), "A3_se", 5, "nan"),
    (STAND, ["table", "A7"], [0.7] * 24, "A7", None, "no declared sensor"),
    (STAND, ["table", "A7_se"], [0.7] * 24, "A7_se", None, "no declared sensor"),
    (FREE, ["site", "gravity_m_s2"], ..., "site.gravity_m_s2", None, "one of them"),
    (FREE, ["direction_sigma_deg"], 1.0, "direction_sigma_deg", None, "without directions"),
    (FREE, ["table", "position"], [1.5, *range(23)], "position", 1, "whole number"),
    (FREE, ["table", "position"], [-2, *range(23)], "position", 1, "whole number"),
    (LOG, ["sample_rate_hz"], 0, "sample_rate_hz", None, "above 0"),
    (LOG, ["table", "A1_se"], [1e-6] * 1640, "A1_se", None, "raw log"),
]  # fmt: skip


@pytest.mark.parametrize(("build", "path", "value", "field", "row", "words"), FAULTS)
def test_one_fault_is_named_with_its_place(build, path, value, field, row, words):
    document = build()
    put(document, path, value)
    found = problems_of(document)
    assert (field, row) in [(p.field, p.row) for p in found], found
    assert any(words in p.message for p in found if (p.field, p.row) == (field, row)), found


@pytest.mark.parametrize(("build", "path", "value", "field", "row", "words"), FAULTS)
def test_one_fault_is_not_reported_as_many(build, path, value, field, row, words):
    document = build()
    put(document, path, value)
    wide = {"sensors", "table", "block", "programme"}  # other checks rest on these
    assert len(problems_of(document)) <= (3 if field.split("[")[0] not in wide else 30)


def test_a_moment_of_switching_on_needs_one_of_the_start():
    document = builders.accelerometer_block() | {"powered_on_at": "2026-03-01T08:20:00Z"}
    del document["started_at"]
    (problem,) = problems_of(document)
    assert (problem.field, "needs started_at" in problem.message) == ("powered_on_at", True)


def test_switching_on_is_stated_once():
    both = {"powered_on_at": "2026-03-01T08:20:00Z", "time_since_power_on_s": 2400}
    (problem,) = problems_of(builders.accelerometer_block() | both)
    assert (problem.field, "one of the two" in problem.message) == ("powered_on_at", True)


def test_a_wrong_start_is_the_only_fault_beside_a_moment_of_switching_on():
    wrong = {"powered_on_at": "2026-03-01T08:20:00Z", "started_at": "yesterday"}
    assert [p.field for p in problems_of(builders.accelerometer_block() | wrong)] == ["started_at"]


def test_all_faults_are_reported_at_once():
    document = builders.accelerometer_block()
    document["stand"]["alpha_deg"] = 90
    document["table"]["A2"][6] = float("nan")
    document["table"]["A4_se"][0] = -1
    document["table"]["time_s"][20] = 0
    places = [(p.field, p.row) for p in problems_of(document)]
    assert places == [("stand.alpha_deg", None), ("time_s", 21), ("A2", 7), ("A4_se", 1)]


@pytest.mark.parametrize("count", [0, 1, 2])
def test_fewer_than_three_sensors(count):
    document = builders.accelerometer_block()
    document["sensors"] = document["sensors"][:count]
    assert any(p.field == "sensors" and f"{count} of kind" in p.message for p in problems_of(document))


def test_axes_in_one_plane():
    document = builders.accelerometer_block(3)
    document["sensors"][2]["nominal_axis"] = document["sensors"][1]["nominal_axis"]
    (problem,) = problems_of(document)
    assert "one plane" in problem.message


def test_each_kind_of_a_mixed_block_must_span_space():
    document = builders.mixed_block(3)
    document["sensors"][5]["nominal_axis"] = document["sensors"][4]["nominal_axis"]
    (problem,) = problems_of(document)
    assert "kind gyroscope lie in one plane" in problem.message


def test_a_torn_direction():
    document = builders.arbitrary_orientations(direction_sigma_deg=2.0)
    document["table"]["direction_y"][2] = None
    (problem,) = problems_of(document)
    assert (problem.field, problem.row) == ("direction_x", 3)


def test_directions_need_their_sigma():
    document = builders.arbitrary_orientations(direction_sigma_deg=2.0)
    del document["direction_sigma_deg"]
    assert problems_of(document)[0].field == "direction_sigma_deg"


@pytest.mark.parametrize(
    ("document", "field"),
    [
        (builders.accelerometer_block(positions=1), "beta_deg"),
        (builders.arbitrary_orientations(orientations=1), "table"),
        (builders.raw_log(orientations=1), "position"),
    ],
)
def test_a_single_position_cannot_be_calibrated(document, field):
    with pytest.raises(ScheduleError, match="single position") as caught:
        read_session(document)
    assert caught.value.problems[0].field == field


@pytest.mark.parametrize(("faulty", "told"), [(180, "175 more rows have"), (6, "1 more row has")])
def test_faulty_rows_beyond_five_are_counted(faulty, told):
    document = builders.accelerometer_block(positions=100)
    document["table"]["A1"][20 : 20 + faulty] = ["x"] * faulty
    found = problems_of(document)
    assert [problem.row for problem in found] == [21, 22, 23, 24, 25, None]
    assert f"{told} this fault, up to row {20 + faulty}" in found[-1].message


def test_a_column_of_one_value_is_told_as_one():
    document = builders.accelerometer_block()
    document["table"]["A1"] = [1.0]
    assert "has 1 value where" in problems_of(document)[0].message


def test_a_fault_of_every_row_is_one_problem():
    document = builders.accelerometer_block(positions=100)
    document["table"]["A1"] = [f"0,{j}" for j in range(200)]
    (problem,) = problems_of(document)
    assert (problem.field, problem.row) == ("A1", None)
    assert "all 200 rows" in problem.message
    assert "decimal point" in problem.message


def test_the_number_of_problems_is_bounded():
    document = builders.accelerometer_block()
    document["sensors"] = [{"name": f"S{k}"} for k in range(1000)]
    found = problems_of(document)
    assert len(found) == 501
    assert "more problems" in found[-1].message


@pytest.mark.parametrize(("columns", "rows"), [(1, 10**7 + 1), (10**4 + 1, 1)])
def test_tables_beyond_all_measure_are_refused(columns, rows):
    document = builders.accelerometer_block() | {"table": {f"c{k}": [0.0] * rows for k in range(columns)}}
    assert any("at most" in p.message for p in problems_of(document))


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "is empty"),
        (b"\xef\xbb\xbf \n", "is empty"),
        (b"null", "neither JSON"),
        (b"[1, 2]", "one JSON object"),
        (b'{"format": "imu-session/1",', "line 1, column"),
        (b"[" * 100_000, "nested"),
        (b'{"a":' * 100_000, "nested"),
        (b'{"a": ' + b"1" * 1_000_000 + b"}", "thousands of digits"),
        (b"\xff\xfe{\x00}\x00", "UTF-16"),
        (b'{"unit": "\xe9"}', "not UTF-8"),
        (b"PK\x03\x04", "neither JSON"),
        (b"a,b\n1,2\n", "without metadata"),
        (b'{"format": "imu-session/1", "format": "imu-session/1"}', "more than once"),
    ],
)
def test_bytes_that_are_no_session(content, words):
    assert any(words in p.message for p in problems_of(content))


@pytest.mark.parametrize("source", ["no/such/file.json", ".", "a\0b", '{"format": 1}', 7, None])
def test_sources_that_cannot_be_read(source):
    with pytest.raises(FormatError):
        read_session(source)


def test_nan_and_infinity_literals_are_found_in_json():
    document = builders.accelerometer_block()
    document["table"]["A1"][:2] = [float("nan"), float("inf")]
    assert [(p.field, p.row) for p in problems_of(json.dumps(document).encode())] == [("A1", 1), ("A1", 2)]


def test_the_message_names_the_source():
    with pytest.raises(FormatError, match=r"^tuesday\.json: format: missing"):
        read_session({}, name="tuesday.json")


def test_a_two_dimensional_array_is_no_column():
    document = builders.accelerometer_block()
    document["table"]["A1"] = np.zeros((24, 1))
    assert problems_of(document)[0].field == "A1"


def test_an_unknown_programme_brings_no_faults_of_another():
    with pytest.raises(FormatError) as caught:
        read_session({**builders.raw_log(), "programme": "in service"})
    assert [problem.field for problem in caught.value.problems] == ["programme"]
