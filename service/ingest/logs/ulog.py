"""ULog of PX4: every instance of `sensor_accel` and `sensor_gyro`, else the one IMU of `sensor_combined`.

Source: PX4 user guide, ULog file format; the messages of PX4-Autopilot, msg/SensorAccel.msg and its neighbours.
"""

import io
import struct
from collections.abc import Iterator
from contextlib import redirect_stdout

import numpy as np
from pyulog import ULog
from pyulog.exceptions import ULogException

from estimator.message import say
from estimator.session import ACCELEROMETER, GYROSCOPE
from service.ingest.logs.readers import Contents
from service.ingest.logs.table import Array, Stream
from service.kit.limits import refusal

RAW = {"sensor_accel": ACCELEROMETER, "sensor_gyro": GYROSCOPE}
COMBINED = {"accelerometer_m_s2": ACCELEROMETER, "gyro_rad": GYROSCOPE}
MICROSECOND = 1e-6
HEADER = 16
"""Bytes before the first message."""
KNOWN = frozenset(b"BFIMPQARDLCSO")
"""Types of message; others are skipped, unless their header is invalid."""
LONGEST = 10_000
"""Bytes of an unknown message that is still accepted, as by the library."""
DAMAGED = (ULogException, struct.error, ValueError, LookupError, TypeError, AttributeError, OverflowError)
"""Raised by the library for truncated or overwritten files."""
BROKEN = "is damaged: some of its messages cannot be read; copy it from the card again"
CUT = "The log ends within a message, as after a loss of power; everything before that was read."
UNREADABLE = "is damaged or not a readable ULog file; copy it from the card again"


def read(content: bytes, filename: str) -> Contents:
    """The IMUs of a log; FormatError where it is damaged. A truncated one is read up to its end."""
    end = _end_of_messages(content, filename)
    try:
        with redirect_stdout(io.StringIO()):  # the library prints what it thinks of a file
            log = ULog(io.BytesIO(content[:end]), [*RAW, "sensor_combined"])
            streams = [*_raw(log)] or [*_combined(log)]
    except DAMAGED as fault:
        raise refusal(filename, UNREADABLE) from fault
    if log.file_corruption:
        raise refusal(filename, BROKEN)
    return Contents(streams, _facts(log, is_whole=end == len(content)))


def _raw(log: ULog) -> Iterator[Stream]:
    for data in sorted(log.data_list, key=lambda data: (data.name, data.multi_id)):
        if data.name in RAW:
            values = np.column_stack([data.data[axis].astype(float) for axis in "xyz"])
            temperature = data.data.get("temperature")
            warm = None if temperature is None else temperature.astype(float)
            yield Stream(f"{data.name} {data.multi_id}", RAW[data.name], _time(data.data), values, warm)


def _combined(log: ULog) -> Iterator[Stream]:
    for data in (data for data in log.data_list if data.name == "sensor_combined"):
        for field, kind in COMBINED.items():
            values = np.column_stack([data.data[f"{field}[{axis}]"].astype(float) for axis in range(3)])
            yield Stream(f"{field} {data.multi_id}", kind, _time(data.data), values)


def _time(data: dict[str, Array]) -> Array:
    """Time of sampling where it is logged, else of publishing."""
    sampled = data.get("timestamp_sample")
    stamps = sampled if sampled is not None and np.all(sampled > 0) else data["timestamp"]
    return MICROSECOND * stamps.astype(float)


def _facts(log: ULog, *, is_whole: bool) -> dict[str, object]:
    """Serial number of the flight controller, and lost samples."""
    lost = sum(dropout.duration for dropout in log.dropouts)
    notes: list[str] = (
        [say("The logger dropped {lost} ms of samples in {dropouts} gaps.", lost=lost, dropouts=len(log.dropouts))]
        if log.dropouts
        else []
    )
    notes += [] if is_whole else [CUT]
    serial = log.msg_info_dict.get("sys_uuid")
    facts = {"unit": serial if isinstance(serial, str) else "", "notes": " ".join(notes)}
    return {key: text for key, text in facts.items() if text}


def _end_of_messages(content: bytes, filename: str) -> int:
    """End of the last complete message: each begins with its length. FormatError where there are no messages.

    The library seeks back by the length that a header states, and loops for ever where the file has fewer bytes.
    """
    offset = HEADER
    while offset + 3 <= len(content):
        size, kind = int.from_bytes(content[offset : offset + 2], "little"), content[offset + 2]
        if kind not in KNOWN and (kind == 0 or not 0 < size <= LONGEST):
            raise refusal(filename, BROKEN)
        if offset + 3 + size > len(content):
            break
        offset += 3 + size
    return offset
