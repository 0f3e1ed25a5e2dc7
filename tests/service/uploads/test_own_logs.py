"""Raw logs of six axes in layouts of many loggers: what the preview says of their columns, rows and rate."""

import json
from io import BytesIO
from typing import Any

import h5py
import httpx
import numpy as np
import pytest
from scipy.io import savemat

from service.ingest import read_upload
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - the hook
from tests.service.six_axis import GRAVITY, Hands, by_hand, counted, moments, numbers, seconds, triad, written, xyz
from tests.service.uploads.test_layouts_page import sent, shown

PREVIEW = "/api/v1/layouts/preview"
HANDS = by_hand()
DEGREES = np.degrees(HANDS.turning)
EPOCH = 1_772_355_590


def clock(heading: str, write: Any, hands: Hands = HANDS) -> tuple[str, list[str]]:
    return heading, [write(t) for t in hands.time]


ONE_A_ROW = [
    f"{1e3 * t + late:.0f},{name},{x:.5f},{y:.5f},{z:.5f}\n".encode()
    for name, values, late in (("GYRO", DEGREES, 2), ("ACCEL", HANDS.force, 0), ("MAG", HANDS.force + 20, 1))
    for t, (x, y, z) in zip(HANDS.time, values, strict=True)
]
"""Rows of a log with one sensor each."""
LAYOUTS: dict[str, tuple[bytes, str, str]] = {
    "german": (
        written(
            [clock("Messzeit [ms]", counted(1e3)), *triad(xyz("Beschleunigung * [m/s²]"), HANDS.force),
             *triad(xyz("Drehrate * [°/s]"), DEGREES)], ";", ",",
        ), "m/s²", "°/s",
    ),
    "russian": (
        written(
            [clock("Время, мкс", counted(1e6)), *triad(xyz("Ускорение *, мg"), HANDS.force / GRAVITY * 1e3),
             *triad(xyz("Угловая скорость *, град/с"), DEGREES), ("Температура, °C", ["23.5"] * len(DEGREES))], ";",
        ), "mg", "°/s",
    ),
    "french": (
        written(
            [clock("Temps (s)", lambda t: seconds(t).replace(".", "\\decimal")),
             *triad(xyz("Accélération *-axe (m/s²)"), HANDS.force),
             *triad(xyz("Vitesse angulaire * (rad/s)"), HANDS.turning)],
            "\t", ",",
        ), "m/s²", "rad/s",
    ),
    "robot": (
        written(
            [clock("%time", counted(1e9, EPOCH * 10**9)),
             *triad(xyz("field.angular_velocity.*", "xyz"), HANDS.turning),
             *triad(xyz("field.linear_acceleration.*", "xyz"), HANDS.force)],
        ), "m/s²", "rad/s",
    ),
    "microcontroller": (
        written(
            [clock("us", counted(1e6, 5_000_000)),
             *triad(xyz("a*", "xyz"), np.round(HANDS.force / GRAVITY * 16384), ".0f"),
             *triad(xyz("g*", "xyz"), np.round(DEGREES * 131), ".0f")],
        ), "count", "count",
    ),
    "day and time": (
        written(
            [clock("Date Time", moments("%d/%m/%Y %H:%M:%S.%f")), *triad(xyz("acc*_g"), HANDS.force / GRAVITY),
             *triad(xyz("gyro*_dps"), DEGREES), *triad(("roll", "pitch", "yaw"), DEGREES)],
        ), "g", "°/s",
    ),
    "units below": (
        written(
            [
                (heading, [unit, *cells])
                for unit, columns in (
                    ("s", [clock("timestamp", seconds)]), ("mdeg/s", triad(xyz("GYRO_*_CAL"), DEGREES * 1e3)),
                    ("m/(s^2)", triad(xyz("ACCEL_*_CAL"), HANDS.force)),
                )
                for heading, cells in columns
            ], "\t",
        ), "m/s²", "mdeg/s",
    ),
    "nothing said": (
        written(
            [clock("t", seconds), *triad(xyz("f*", "xyz"), HANDS.force), *triad(xyz("omega_*", "xyz"), DEGREES)], ";"
        ), "m/s²", "°/s",
    ),
    "rate in a title": (
        written(
            [*triad(xyz("Acc_*"), HANDS.force), *triad(xyz("Gyr_*"), HANDS.turning)], "\t",
            above="// Update Rate: 100.0Hz\n// Filter: 42 Hz\n",
        ), "m/s²", "rad/s",
    ),
    "ticks of a stated rate": (
        written(
            [clock("SampleTimeFine", counted(1e4)), *triad(xyz("Acc_*"), HANDS.force),
             *triad(xyz("Gyr_*"), HANDS.turning)], "\t", above="// Output rate: 100.0Hz\n",
        ), "m/s²", "rad/s",
    ),
    "turns by their axes alone": (
        written([clock("T", seconds), *triad(xyz("A*"), HANDS.force / GRAVITY), *triad(xyz("R*"), DEGREES)], " "),
        "g", "°/s",
    ),
    "brackets first, counts of a thermometer": (
        written(
            [clock("Time", moments("%d-%b-%Y %H:%M:%S.%f")),
             *triad(xyz("*_ACCL_OUT [mg]"), HANDS.force / GRAVITY * 1e3),
             *triad(xyz("*_GYRO_OUT [mdps]"), DEGREES * 1e3), ("TEMP_OUT", ["2560"] * len(DEGREES))],
            above="[Log Started]\n",
        ), "mg", "mdeg/s",
    ),
    **{
        name: (
            b"t [ms],sensor,x,y,z\n" + b"".join(rows), "m/s²", "°/s",
        )
        for name, rows in (
            ("a sensor after another", ONE_A_ROW),
            ("a sensor a row", sorted(ONE_A_ROW, key=lambda row: int(row.split(b",")[0]))),
        )
    },
    "no headings": (
        written([clock("5123", counted(1e3, 5123)), *triad(["1"] * 3, HANDS.force), *triad(["2"] * 3, DEGREES)]).split(
            b"\n", 1
        )[1], "m/s²", "°/s",
    ),
}  # fmt: skip
"""Each with the units of its accelerometers and gyros."""


def previewed(client: httpx.Client, content: bytes, name: str = "log.csv", mapping: Any = None) -> dict[str, Any]:
    stated = {} if mapping is None else {"mapping": json.dumps(mapping)}
    answer = client.post(PREVIEW, files={"file": (name, content)}, data=stated)
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


def fields(found: dict[str, Any]) -> set[str]:
    return {problem["field"] for problem in found["problems"]}


FACTS_OF_EVERY_LOG = {"unit", "site.gravity_m_s2"}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_kinds_units_and_rate_of_a_log_are_proposed(client: httpx.Client, layout: str) -> None:
    content, of_accelerometers, of_gyros = LAYOUTS[layout]
    found = previewed(client, content)
    session = found["mapping"]["session"]
    assert (session["programme"], session["sample_rate_hz"]) == ("arbitrary-orientations", pytest.approx(100, rel=1e-3))
    units = {
        kind: {s["reading_unit"] for s in session["sensors"] if s["kind"] == kind}
        for kind in ("accelerometer", "gyroscope")
    }
    assert units == {"accelerometer": {of_accelerometers}, "gyroscope": {of_gyros}}
    assert len(session["sensors"]) == 6
    assert fields(found) == FACTS_OF_EVERY_LOG


@pytest.mark.parametrize(
    ("first", "started_at"),
    [
        (clock("time_ns", counted(1e9, EPOCH * 10**9)), "2026-03-01T08:59:50Z"),
        (clock("Time", lambda t: moments("%Y-%m-%d %H:%M:%S.%f")(t) + " +0100"), "2026-03-01T09:59:50+01:00"),
        (clock("Time", moments("%H:%M:%S.%f")), None),
        (clock("Time (ms)", counted(1e3, 5000)), None),
    ],
)
def test_a_session_starts_at_the_first_of_its_times(client: httpx.Client, first: Any, started_at: str | None) -> None:
    found = previewed(client, written([first, *triad(xyz("Acc_*"), HANDS.force), *triad(xyz("Gyr_*"), HANDS.turning)]))
    assert found["mapping"]["session"].get("started_at") == started_at
    assert fields(found) == FACTS_OF_EVERY_LOG


@pytest.mark.parametrize("layout", LAYOUTS)
def test_first_rows_of_a_log_are_in_si(client: httpx.Client, layout: str) -> None:
    mapping = previewed(client, LAYOUTS[layout][0])["mapping"]
    mapping["session"] |= {"unit": "H-1", "site": {"gravity_m_s2": 9.81}}
    found = previewed(client, LAYOUTS[layout][0], mapping=mapping)
    assert found["problems"] == []
    row = found["first_rows"][1]
    names = [sensor["name"] for sensor in sorted(mapping["session"]["sensors"], key=lambda s: s["name"])]
    felt, turning = ([row[name] for name in part] for part in (names[:3], names[3:]))
    np.testing.assert_allclose(felt, HANDS.force[1], rtol=0.01, atol=0.05)
    np.testing.assert_allclose(turning, HANDS.turning[1], rtol=0.03, atol=0.001)


def in_counts(per_g: float, per_degree: float, signs: Any = 1.0, per_second: float = 1e3) -> bytes:
    """A log of whole numbers; ``per_second``: ticks of a clock that its heading calls ms."""
    felt, turned = HANDS.force / GRAVITY * per_g, DEGREES * signs * per_degree
    triads = [*triad(xyz("Acc * (LSB)"), felt, ".0f"), *triad(xyz("Gyr * (LSB)"), turned, ".0f")]
    return written([clock("Time (ms)", counted(per_second)), *triads])


def test_what_the_values_contradict_of_the_last_file_is_not_taken(client: httpx.Client) -> None:
    page = shown(client.post("/upload/layout", files={"file": ("log.csv", in_counts(16384, 131))}).text)
    said = {"fact.unit": "WIDE", "fact.day": "2026-03-01", "fact.site.latitude_deg": "55.8"}
    assert sent(client, shown(sent(client, page, **said, do="look").text), do="store").status_code == 303
    for content, scales, sign, rate in (
        (in_counts(16384, 131), (1671, 7506), 1, 100.0),
        (in_counts(2048, 131), (209, 7506), 1, 100.0),
        (in_counts(16384, 16.4), (1671, 940), 1, 100.0),
        (in_counts(16384, 131, [1.0, -1.0, 1.0]), (1671, 7506), -1, 100.0),
        (in_counts(16384, 65.5, per_second=2e3), (1671, 7506), 1, 50.0),
    ):
        found = previewed(client, content)["mapping"]["session"]
        by_name = {sensor["name"]: sensor for sensor in found["sensors"]}
        assert found["sample_rate_hz"] == pytest.approx(rate)
        assert [by_name[name]["nominal_scale"] for name in ("AX", "GX")] == pytest.approx(scales, rel=0.05)
        assert by_name["GY"]["nominal_axis"] == [0, sign, 0]


def test_a_gyro_of_the_other_sign_is_proposed_against_its_axis(client: httpx.Client) -> None:
    columns = [clock("t [s]", seconds), *triad(("ax", "ay", "az"), HANDS.force)]
    turning = HANDS.turning * [1.0, -1.0, 1.0]
    content = written([*columns, *triad(("wx", "wy", "wz"), turning)])
    found = previewed(client, content)
    axes = {sensor["name"]: sensor["nominal_axis"] for sensor in found["mapping"]["session"]["sensors"]}
    assert (axes["GX"], axes["GY"], axes["GZ"]) == ([1, 0, 0], [0, -1, 0], [0, 0, 1])
    page = client.post("/upload/layout", files={"file": ("log.csv", content)}, headers={"Accept": "text/html"}).text
    assert "GY: by the turns in the log these gyros run against the accelerometers" in " ".join(page.split())


def test_columns_without_headings_are_recognised_by_gravity_and_its_turns(client: httpx.Client) -> None:
    content = written([clock("t", seconds), *triad(xyz("*"), HANDS.turning), *triad(xyz("*"), HANDS.force)])
    found = previewed(client, b"\n".join(content.splitlines()[1:]))
    assert [column["kind"] for column in found["columns"]] == ["time", *["gyroscope"] * 3, *["accelerometer"] * 3]


def test_accelerations_freed_from_gravity_are_no_accelerometers(client: httpx.Client) -> None:
    freed = HANDS.force - HANDS.force
    columns = [clock("t [s]", seconds), *triad(xyz("Linear Acceleration * (m/s^2)", "xyz"), freed + 0.01)]
    found = previewed(client, written([*columns, *triad(xyz("Gravity * (m/s^2)", "xyz"), HANDS.force)]))
    assert [column["kind"] for column in found["columns"]] == ["time", *["ignored"] * 6]


def test_what_is_written_raw_and_calibrated_is_taken_once(client: httpx.Client) -> None:
    raw = triad(xyz("Accel_*_RAW"), np.round(HANDS.force * 500), ".0f")
    columns = [clock("t [s]", seconds), *raw, *triad(xyz("Accel_*_CAL [m/s²]"), HANDS.force)]
    found = previewed(client, written(columns))
    assert [column["kind"] for column in found["columns"]] == ["time", *["ignored"] * 3, *["accelerometer"] * 3]


def test_two_devices_are_two_triads(client: httpx.Client) -> None:
    other = by_hand(2).force
    columns = [clock("t [s]", seconds), *triad(xyz("acc1_*"), HANDS.force), *triad(xyz("acc2_*"), other)]
    found = previewed(client, written(columns))
    assert [column["as"] for column in found["mapping"]["columns"]] == [
        "time_s", "AX", "AY", "AZ", "A2X", "A2Y", "A2Z",
    ]  # fmt: skip


def test_a_log_without_a_clock_asks_for_its_rate_alone(client: httpx.Client) -> None:
    content = written([*triad(xyz("acc *"), HANDS.force), *triad(xyz("gyr *"), HANDS.turning)])
    found = previewed(client, content)
    assert fields(found) == {*FACTS_OF_EVERY_LOG, "sample_rate_hz"}
    answered = found["mapping"]
    answered["session"]["sample_rate_hz"] = 100.0
    again = previewed(client, content, mapping=answered)
    assert {s["reading_unit"] for s in again["mapping"]["session"]["sensors"]} == {"m/s²", "rad/s"}
    assert fields(again) == FACTS_OF_EVERY_LOG


def test_ticks_of_an_unknown_unit_are_asked(client: httpx.Client) -> None:
    content = written([clock("time", counted(1e4)), *triad(xyz("acc * [g]"), HANDS.force / GRAVITY)])
    found = previewed(client, content)
    assert fields(found) == {*FACTS_OF_EVERY_LOG, "time_s"}
    (asked,) = (problem["message"] for problem in found["problems"] if problem["field"] == "time_s")
    assert "is without a unit" in asked


def test_gyros_of_which_no_turn_tells_the_unit_are_asked(client: httpx.Client) -> None:
    still = np.tile(HANDS.force[:50], (20, 1))
    hands = Hands(100.0, np.arange(1000) / 100, still, np.tile(HANDS.turning[:50], (20, 1)))
    columns = [clock("t [s]", seconds, hands), *triad(xyz("acc *"), still), *triad(xyz("gyr *"), hands.turning)]
    found = previewed(client, written(columns))
    assert "sensors[4].nominal_scale" in fields(found)
    columns_stated = found["mapping"]["columns"]
    columns_stated[4]["unit"] = "°/s"
    again = previewed(client, written(columns), mapping=found["mapping"])
    assert fields(again) == FACTS_OF_EVERY_LOG


def test_a_unit_that_gravity_or_the_turns_contradict_is_asked(client: httpx.Client) -> None:
    columns = [clock("t [s]", seconds), *triad(xyz("acc* [m/s²]"), HANDS.force / GRAVITY)]
    found = previewed(client, written([*columns, *triad(xyz("gyr* [rad/s]"), DEGREES)]))
    assert {f"sensors[{k}].reading_unit" for k in range(1, 7)} <= fields(found)


def test_axes_are_also_called_by_the_vehicle(client: httpx.Client) -> None:
    columns = [clock("t [s]", seconds), *triad([f"{one} rate [deg/s]" for one in ("Roll", "Pitch", "Yaw")], DEGREES)]
    names = [f"{one} acceleration [m/s²]" for one in ("Longitudinal", "Lateral", "Vertical")]
    assert read_as(client, written([*columns, *triad(names, HANDS.force)])) == (
        ["time_s", "GX", "GY", "GZ", "AX", "AY", "AZ"], 100.0,
    )  # fmt: skip


def test_a_kind_against_its_unit_is_asked(client: httpx.Client) -> None:
    content = LAYOUTS["german"][0]
    mapping = previewed(client, content)["mapping"]
    mapping["session"]["sensors"][3]["kind"] = "accelerometer"
    assert "sensors[4].reading_unit" in fields(previewed(client, content, mapping=mapping))


def test_few_rows_with_directions_are_rests(client: httpx.Client) -> None:
    rng = np.random.default_rng(3)
    up = rng.standard_normal((12, 3))
    up /= np.linalg.norm(up, axis=1)[:, None]
    columns = [*triad(("dir x", "dir y", "dir z"), up), *triad(xyz("acc * [g]"), up)]
    session = previewed(client, written(columns))["mapping"]["session"]
    assert (session["programme"], "sample_rate_hz" in session) == ("arbitrary-orientations", False)


def test_rows_by_run_and_angle_are_a_stand(client: httpx.Client) -> None:
    angle = np.tile(np.arange(0, 360, 30.0), 2)
    run = ("run", ["direct"] * 12 + ["flipped"] * 12)
    columns = [run, ("beta [deg]", numbers(angle)), *triad(xyz("acc * [g]"), HANDS.force[: len(angle)])]
    assert previewed(client, written(columns))["mapping"]["session"]["programme"] == "two-axis-stand"


def kinds_shown(page: str, count: int) -> list[str]:
    fields = shown(page)
    return [fields[f"kind.{k}"] for k in range(count)]


@pytest.mark.parametrize("layout", LAYOUTS)
def test_the_page_shows_a_kind_for_every_column_and_stores_a_log(client: httpx.Client, layout: str) -> None:
    content = LAYOUTS[layout][0]
    fields = shown(client.post("/upload/layout", files={"file": ("log.csv", content)}).text)
    said = {"fact.unit": "H-1", "fact.day": "2026-03-01", "fact.clock": "09:00", "fact.site.gravity_m_s2": "9.81"}
    looked = shown(sent(client, fields, **said, do="look").text)
    answer = sent(client, looked, do="store")
    assert answer.status_code == 303, answer.text
    id = answer.headers["location"].rpartition("/")[2]
    session = read_upload(client.get(f"/api/v1/sessions/{id}/file").content, "log")
    assert [sensor.kind for sensor in session.sensors].count("gyroscope") == 3


def test_a_column_of_another_kind_is_said_by_hand(client: httpx.Client) -> None:
    content = written([clock("t [s]", seconds), *triad(("p", "q", "r"), HANDS.turning), *triad(xyz("a*"), HANDS.force)])
    page = client.post("/upload/layout", files={"file": ("log.csv", content)}).text
    assert kinds_shown(page, 7) == ["time", *["ignored"] * 3, *["accelerometer"] * 3]
    changed = sent(client, shown(page), **{f"kind.{k}": "gyroscope" for k in (1, 2, 3)}, do="look").text
    assert kinds_shown(changed, 7) == ["time", *["gyroscope"] * 3, *["accelerometer"] * 3]
    fields = shown(changed)
    assert [fields[f"as.{k}"] for k in (1, 2, 3)] == ["G1", "G2", "G3"]
    assert fields["sensor.G1.unit"] == "rad/s"


def test_a_sensor_of_another_kind_keeps_its_name_and_takes_the_unit_of_its_column(client: httpx.Client) -> None:
    page = client.post("/upload/layout", files={"file": ("log.csv", LAYOUTS["german"][0])}).text
    change = {f"kind.{k}": "accelerometer" for k in (4, 5, 6)} | {f"unit.{k}": "mg" for k in (4, 5, 6)}
    fields = shown(sent(client, shown(page), **change, do="look").text)
    assert (fields["as.4"], fields["kind.4"], fields["sensor.GX.unit"]) == ("GX", "accelerometer", "mg")
    assert float(fields["sensor.GX.scale"]) == pytest.approx(1000 / GRAVITY)


def test_a_column_is_ignored_by_its_kind(client: httpx.Client) -> None:
    page = client.post("/upload/layout", files={"file": ("log.csv", LAYOUTS["russian"][0])}).text
    fields = shown(sent(client, shown(page), **{"kind.7": "ignored", "do": "look"}).text)
    assert (fields["as.7"], fields["kind.7"]) == ("", "ignored")


def text_of(*lines: str) -> bytes:
    return "\n".join(lines).encode()


def read_as(client: httpx.Client, content: bytes, name: str = "log.txt") -> tuple[list[str | None], float]:
    """Meanings of the columns, and the rate."""
    mapping = previewed(client, content, name)["mapping"]
    return [column["as"] for column in mapping["columns"]], mapping["session"].get("sample_rate_hz")


CELLS = [
    seconds(t) + "".join(f" {value:.5f}" for value in force) for t, force in zip(HANDS.time, HANDS.force, strict=True)
]


@pytest.mark.parametrize(
    "content",
    [
        text_of("time ax ay az", *CELLS),
        text_of("# recorded by hand", "# time [s]  ax [m/s^2] ay [m/s^2] az [m/s^2]", *CELLS),
        text_of("time  ax    ay   az", *(cell.replace(" ", "    ").replace(".", ",") for cell in CELLS)),
        text_of("time;\tax;\tay;\taz;", *(cell.replace(" ", ";\t") + ";" for cell in CELLS)),
        text_of('"sep=,"', "time,ax,ay,az,", *(cell.replace(" ", ",") + "," for cell in CELLS)),
        text_of(
            '"firmware","4.2"', '"acc_1G",2048', '"time","ax","ay","az"', *(cell.replace(" ", ",") for cell in CELLS)
        ),
    ],
    ids=[
        "blanks",
        "comments",
        "decimal commas among blanks",
        "two signs",
        "a sign behind each value",
        "settings above",
    ],
)
def test_a_log_is_cut_whatever_stands_between_its_values(client: httpx.Client, content: bytes) -> None:
    meanings, rate = read_as(client, content)
    assert ([meaning for meaning in meanings if meaning], rate) == (["time_s", "AX", "AY", "AZ"], 100.0)


def test_of_records_of_several_kinds_the_most_are_read(client: httpx.Client) -> None:
    lines = [
        "$COL,GNSS,time,lat,lon",
        "$COL,INERTIAL,time,ax,ay,az",
        "$UNIT,GNSS,s,deg,deg",
        "$UNIT,INERTIAL,s,m/s^2,m/s^2,m/s^2",
    ]
    for k, cell in enumerate(CELLS):
        lines += [f"$GNSS,{k / 100},47.1,8.5"] * (k % 10 == 0) + ["$INERTIAL," + cell.replace(" ", ",")]
    found = previewed(client, text_of(*lines))
    assert found["mapping"]["table"]["record"] == "INERTIAL"
    assert read_as(client, text_of(*lines)) == (["time_s", "AX", "AY", "AZ"], 100.0)
    assert found["rows"] == len(CELLS)


def mat(**variables: Any) -> bytes:
    buffer = BytesIO()
    savemat(buffer, variables)
    return buffer.getvalue()


def test_matrices_and_structures_of_matlab_are_columns(client: httpx.Client) -> None:
    both = {"accel": HANDS.force, "gyro": HANDS.turning.T, "t": HANDS.time}
    expected = (["A1", "A2", "A3", "G1", "G2", "G3", "time_s"], 100.0)
    assert read_as(client, mat(**both), "log.mat") == expected
    assert read_as(client, mat(data={"imu": both}, note="by hand"), "log.mat")[1] == 100.0
    assert read_as(client, mat(log=both), "log.mat") == expected


def test_a_variable_says_the_rate(client: httpx.Client) -> None:
    assert read_as(client, mat(acc=HANDS.force, fs=100.0), "log.mat") == (["A1", "A2", "A3"], 100.0)


def test_structures_of_matlab_7_3_are_columns(client: httpx.Client) -> None:
    buffer = BytesIO()
    with h5py.File(buffer, "w", userblock_size=512) as file:
        for name, values in (("imu/t", HANDS.time[None]), ("imu/acc", HANDS.force.T), ("imu/gyr", HANDS.turning.T)):
            file[name] = values
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
        file["#refs#/a"] = [1.0]
    content = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512, b"\0") + buffer.getvalue()[512:]
    meanings, rate = read_as(client, content, "log.mat")
    assert (sorted(map(str, meanings)), rate) == (["A1", "A2", "A3", "G1", "G2", "G3", "time_s"], 100.0)
