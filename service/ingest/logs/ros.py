"""Messages of ROS 2 → streams: every topic of sensor_msgs/msg/Imu is an instance.

Source: REP 103 (SI units), sensor_msgs/msg/Imu (a covariance that begins with −1 says that there is no such sensor).
"""

from array import array
from collections.abc import Iterable, Iterator
from datetime import UTC, datetime
from functools import cache
from typing import Any

import numpy as np
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

from estimator.message import say
from estimator.session import ACCELEROMETER, GYROSCOPE
from service.ingest.logs.readers import Contents
from service.ingest.logs.table import Array, Stream
from service.kit.limits import refusal

IMU = "sensor_msgs/msg/Imu"
CDR = "cdr"
"""ROS 2's encoding of messages, as bags name it."""
NANOSECOND = 1e-9
EARLIEST, LATEST = 946_684_800.0, 4_102_444_800.0
"""2000 and 2100, s since 1970: a clock outside counts from something else."""
COLUMNS = 9
"""Columns of an instance: two times, three rates, three accelerations, and which of the two are present."""
Message = tuple[str, int, bytes]
"""Topic, time of the log in ns, content."""
DAMAGED = (SerdeError, ValueError, IndexError, TypeError, OverflowError)
"""Raised by the library for malformed content."""
WRONG = "contains a message of {topic} that is not {kind}; record it again"
NONE = "contains no topic of {kind}; record the raw IMU data"


def contents(messages: Iterable[Message], filename: str) -> Contents:
    """All topics of the messages, by name."""
    rows: dict[str, array[float]] = {}
    for topic, logged, content in messages:
        try:
            rows.setdefault(topic, array("d")).extend(_row(logged, content))
        except DAMAGED as fault:
            raise refusal(filename, WRONG, "table", topic=topic, kind=IMU) from fault
    if not rows:
        raise refusal(filename, NONE, "table", kind=IMU)
    tables = {topic: np.frombuffer(cells).reshape(-1, COLUMNS) for topic, cells in sorted(rows.items())}
    streams = [stream for topic, table in tables.items() for stream in _streams(topic, table)]
    return Contents(streams, _facts(streams))


@cache
def _store() -> Typestore:
    return get_typestore(Stores.ROS2_HUMBLE)


def _row(logged: int, content: bytes) -> tuple[float, ...]:
    message: Any = _store().deserialize_cdr(content, IMU)
    rate, force = message.angular_velocity, message.linear_acceleration
    missing = 2 * (message.angular_velocity_covariance[0] == -1) + (message.linear_acceleration_covariance[0] == -1)
    stamp = message.header.stamp
    stamped_at = stamp.sec + NANOSECOND * stamp.nanosec
    return stamped_at, NANOSECOND * logged, rate.x, rate.y, rate.z, force.x, force.y, force.z, float(missing)


def _streams(topic: str, table: Array) -> Iterator[Stream]:
    missing = table[0, 8]
    time = table[:, 0] if np.all(np.diff(table[:, 0]) > 0) else table[:, 1]
    if missing not in (1.0, 3.0):
        yield Stream(say("{topic} acceleration", topic=topic), ACCELEROMETER, time, table[:, 5:8])
    if missing < 2.0:
        yield Stream(say("{topic} rate", topic=topic), GYROSCOPE, time, table[:, 2:5])


def _facts(streams: Iterable[Stream]) -> dict[str, object]:
    """The start of the measurement, where the clock is plausible."""
    first = max((float(stream.time[0]) for stream in streams if len(stream.time)), default=0.0)
    return {"started_at": datetime.fromtimestamp(first, UTC).isoformat()} if EARLIEST < first < LATEST else {}
