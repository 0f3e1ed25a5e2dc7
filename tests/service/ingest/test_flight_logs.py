"""Logs of flight controllers and robots: one clock for all IMUs, and a sentence for what cannot be read."""

import random
import sqlite3
import struct
import sys
from dataclasses import replace

import numpy as np
import pytest

from estimator.errors import FormatError, SessionError
from service.ingest import look_at, read_upload
from service.ingest.logs import LogTable, log_of
from service.kit import limits
from tests.service.ingest import flight_logs as made

FOUND = made.imus(orientations=4)
FILES = {kind: write(FOUND) for kind, write in made.WRITERS.items()}
TRIADS = {"A": made.BIAS, "G": made.GYRO_BIAS}


def table_of(content: bytes) -> LogTable:
    """The table that a log becomes."""
    table = log_of(content, "log")
    assert table is not None
    return table


def refused(content: bytes, words: str) -> None:
    """Refused with these words, by a process of its own as every log is."""
    with pytest.raises(FormatError, match=words):
        look_at(content, "log")


@pytest.mark.parametrize("kind", FILES)
def test_every_instance_is_six_columns_on_one_clock(kind: str) -> None:
    table = table_of(FILES[kind])
    named = [*(f"A{k}" for k in range(1, 7)), *(f"G{k}" for k in range(1, 7))]
    assert [meaning for meaning in table.meanings if meaning[0] in "AG"] == named
    assert table.facts["sample_rate_hz"] == 50.0
    time = table.columns["time [s]"]
    assert np.allclose(np.diff(time), 0.02)
    assert 15.9 < time[-1] < 16.0


@pytest.mark.parametrize("kind", FILES)
def test_a_row_is_the_mean_of_what_was_measured_in_its_span(kind: str) -> None:
    columns = list(table_of(FILES[kind]).columns.values())
    for number, imu in enumerate(FOUND):
        still = slice(10, 140)  # 0.2 to 2.8 s, all in the first rest
        samples = imu.force[(imu.time > 0.2) & (imu.time < 2.8)]
        means = np.column_stack(columns[1 + 3 * number : 4 + 3 * number])[still]
        assert np.allclose(means.mean(axis=0), samples.mean(axis=0), atol=1e-3)
        assert np.all(means.std(axis=0) < made.NOISE)


def test_a_bag_in_either_storage_is_the_same_table() -> None:
    first, second = (table_of(FILES[kind]) for kind in ("mcap", "bag"))
    assert list(first.columns) == list(second.columns)
    assert all(np.array_equal(first.columns[name], second.columns[name]) for name in first.columns)
    assert first.facts == second.facts


def test_messages_without_a_stamp_have_the_log_s_time() -> None:
    unstamped = table_of(made.mcap(FOUND, stamped=False))
    assert len(unstamped.columns["time [s]"]) == len(table_of(FILES["mcap"]).columns["time [s]"])


def test_rows_in_which_a_sensor_says_nothing_are_left_out() -> None:
    gap = (FOUND[0].time > 5) & (FOUND[0].time < 6)
    torn = made.Imu(FOUND[0].time[~gap], FOUND[0].force[~gap], FOUND[0].rate[~gap])
    table = table_of(made.ulog([torn, FOUND[1]]))
    assert np.diff(table.columns["time [s]"]).max() == pytest.approx(1.0, abs=0.03)
    assert "rows left out: an IMU has no data" in str(table.facts["notes"])


def test_an_imu_with_hardly_a_sample_is_left_out_and_named() -> None:
    short = made.Imu(FOUND[1].time[:50], FOUND[1].force[:50], FOUND[1].rate[:50])
    table = table_of(made.ulog([FOUND[0], short]))
    assert [meaning for meaning in table.meanings if meaning[0] in "AG"] == ["A1", "A2", "A3", "G1", "G2", "G3"]
    assert "sensor_accel 1 has 50 samples only" in str(table.facts["notes"])


def test_samples_that_are_no_numbers_are_left_out_and_counted() -> None:
    force = FOUND[0].force.copy()
    force[7:10, 1] = np.nan
    table = table_of(made.ulog([made.Imu(FOUND[0].time, force, FOUND[0].rate), FOUND[1]]))
    assert [(f.kind, f.rows) for f in table.screening] == [("missing", 3)]
    assert np.isfinite(np.column_stack(list(table.columns.values()))).all()


def test_what_the_logger_dropped_is_said() -> None:
    assert "dropped 120 ms" in str(table_of(made.ulog(FOUND, dropout_ms=120)).facts["notes"])


def test_a_log_whose_power_went_is_read_up_to_there_and_says_so() -> None:
    table = table_of(FILES["ulog"][: len(FILES["ulog"]) // 2 + 5])
    assert "ends within a message" in str(table.facts["notes"])
    assert 7 < table.columns["time [s]"][-1] < 9
    assert "notes" not in table_of(FILES["ulog"]).facts


@pytest.mark.parametrize("kind", ["mcap", "bag"])
def test_a_bag_that_breaks_off_is_refused(kind: str) -> None:
    for share in (0.3, 0.9, 0.999):
        refused(FILES[kind][: int(share * len(FILES[kind]))], "is damaged")


def test_a_log_of_which_only_the_head_is_left_is_refused() -> None:
    for end in (7, 15, 16, 100, 300):
        refused(FILES["ulog"][:end], "is damaged|contains no accelerometer")


def test_a_log_that_was_written_over_is_refused() -> None:
    content = bytearray(FILES["ulog"])
    content[5_000:5_400] = bytes(400)
    refused(bytes(content), "is damaged: some")


def read_or_refused(content: bytes) -> None:
    """A file that is no table is refused with its problems."""
    refusal = None
    try:
        look_at(content, "log")
    except SessionError as fault:
        refusal = fault
    assert refusal is None or refusal.problems


@pytest.mark.parametrize("kind", FILES)
def test_logs_that_were_damaged_at_random_end_in_a_table_or_in_words(kind: str) -> None:
    rng = random.Random(kind)
    for _ in range(6):
        content = bytearray(FILES[kind])
        for _ in range(rng.randint(1, 5)):
            at = rng.randrange(len(content))
            content[at : at + rng.randint(0, 8)] = rng.randbytes(rng.randint(0, 8))
        read_or_refused(bytes(content))


def test_times_that_no_clock_counts_are_refused_before_they_cost_anything() -> None:
    far = [made.Imu(np.append(imu.time[:-1], 1e9), imu.force, imu.rate) for imu in FOUND]
    refused(made.ulog(far), "rows; at most")


def test_a_log_too_slow_to_see_a_rest_is_refused() -> None:
    slow = [made.Imu(100 * imu.time, imu.force, imu.rate) for imu in FOUND]
    refused(made.ulog(slow), "1 samples a second; at least 4")


def test_imus_that_were_never_on_together_are_refused() -> None:
    late = made.Imu(FOUND[1].time + 1e4, FOUND[1].force, FOUND[1].rate)
    refused(made.ulog([FOUND[0], late]), "times do not overlap")


def test_a_log_without_an_accelerometer_is_refused() -> None:
    refused(made.ulog([]), "contains no accelerometer")
    refused(made.mcap([]), "contains no topic of sensor_msgs/msg/Imu")


def test_a_message_that_is_none_is_refused_with_its_topic() -> None:
    content = bytearray(FILES["bag"])
    connection = sqlite3.connect(":memory:")
    connection.deserialize(bytes(content))
    connection.execute("UPDATE messages SET data = x'00010000' WHERE id = 3")
    connection.commit()
    refused(bytes(connection.serialize()), "/imu0/data_raw|/imu1/data_raw")
    connection.close()


def test_another_database_is_no_bag() -> None:
    connection = sqlite3.connect(":memory:")
    connection.execute("CREATE TABLE messages (id, topic_id, timestamp, data)")
    connection.commit()
    refused(bytes(connection.serialize()), "not a rosbag2")
    connection.close()


def test_a_message_longer_than_the_file_takes_no_memory() -> None:
    refused(FILES["ulog"][:16] + struct.pack("<HB", 0xFFFF, ord("F")) + b"a:", "is damaged|contains no accelerometer")


def test_a_log_alone_says_what_it_needs() -> None:
    with pytest.raises(FormatError, match="choose it on the upload page"):
        read_upload(FILES["ulog"], "flight.ulg")


@pytest.mark.parametrize(("kind", "library"), [("ulog", "pyulog"), ("mcap", "mcap"), ("bag", "rosbags")])
def test_without_its_library_a_log_says_what_to_install(
    kind: str, library: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    rooms = [f"service.ingest.logs.{room}" for room in ("ulog", "ros", "mcap_file", "sqlite_bag")]
    for name in [name for name in sys.modules if name in rooms or name.split(".")[0] == library]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(FormatError, match=rf"{library}.*imu-health\[logs\]"):
        log_of(FILES[kind], "log")


def test_a_log_of_more_rows_than_may_be_held_is_refused() -> None:
    usual = limits.in_force()
    limits.use(replace(usual, cells=5_000))
    try:
        refused(FILES["ulog"], "at most 5000 cells")
    finally:
        limits.use(usual)
