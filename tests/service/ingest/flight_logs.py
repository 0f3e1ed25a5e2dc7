"""Logs as a flight controller and a robot write them: a block of two IMUs that is set down in many orientations.

ULog is written byte by byte, by its published format; bags by the libraries' own writers.
"""

import io
import struct
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from mcap.writer import Writer as McapWriter
from numpy.typing import NDArray
from rosbags.rosbag2 import Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

Array = NDArray[np.float64]
GRAVITY = 9.81
RATES = (100.0, 125.0)
"""Hz, of the two IMUs: no clock is the other's."""
REST, MOVE = 3.0, 1.0
"""s."""
BIAS = np.array([[0.02, -0.03, 0.05], [-0.04, 0.01, 0.02]])
"""m/s², what the accelerometers of each IMU read without input."""
GYRO_BIAS = np.array([[0.001, -0.002, 0.003], [0.002, 0.001, -0.001]])
"""rad/s."""
NOISE, GYRO_NOISE = 0.005, 0.0005
"""One sigma of a sample."""
START_NS = 1_780_000_000 * 10**9
"""Time of a robot's clock, ns: 2026-05-28."""
UUID = "0002000000003439373332335105003b0025"
STORE = get_typestore(Stores.ROS2_HUMBLE)


@dataclass(frozen=True)
class Imu:
    """Samples of one instance."""

    time: Array
    """(n,) s."""
    force: Array
    """(n, 3) m/s²."""
    rate: Array
    """(n, 3) rad/s."""


def directions(count: int) -> Array:
    """(count, 3) where up points, block axes: along a spiral over the sphere, each far from the one before."""
    k = np.arange(count)
    z, turn = 1 - 2 * (k + 0.5) / count, 2.399963 * k
    aside = np.sqrt(1 - z**2)
    spread = np.column_stack([aside * np.cos(turn), aside * np.sin(turn), z])
    return spread[(7 * k) % count]


def imus(orientations: int = 18, seed: int = 5) -> list[Imu]:
    """Two IMUs in one block: still in every orientation, turning in between."""
    rng = np.random.default_rng(seed)
    up = directions(orientations)
    found = []
    for number, hertz in enumerate(RATES):
        time = np.arange(0.0, orientations * (REST + MOVE), 1 / hertz) + 0.001 * number
        place = np.minimum((time / (REST + MOVE)).astype(int), orientations - 1)
        share = np.clip((time - place * (REST + MOVE) - REST) / MOVE, 0, 1)[:, None]
        following = up[np.minimum(place + 1, orientations - 1)]
        pointing = (1 - share) * up[place] + share * following
        pointing /= np.linalg.norm(pointing, axis=1, keepdims=True)
        moving = (share > 0) * rng.uniform(0.5, 1.0, 3)
        force = GRAVITY * pointing + BIAS[number] + rng.normal(0, NOISE, (len(time), 3))
        rate = GYRO_BIAS[number] + moving + rng.normal(0, GYRO_NOISE, (len(time), 3))
        found.append(Imu(time, force, rate))
    return found


def ulog(found: list[Imu], *, dropout_ms: int = 0) -> bytes:
    """PX4's log: definitions, then subscriptions, then samples in the order of their times."""
    parts = [b"ULog\x01\x125" + bytes([1]) + struct.pack("<Q", 0), _message("B", bytes(40))]
    key = f"char[{len(UUID)}] sys_uuid".encode()
    parts.append(_message("I", bytes([len(key)]) + key + UUID.encode()))
    fields = (
        "uint64_t timestamp;uint64_t timestamp_sample;uint32_t device_id;float x;float y;float z;float temperature;"
    )
    parts += [_message("F", f"{name}:{fields}".encode()) for name in ("sensor_accel", "sensor_gyro")]
    samples = []
    for instance, imu in enumerate(found):
        for kind, (name, values) in enumerate((("sensor_accel", imu.force), ("sensor_gyro", imu.rate))):
            id = 2 * instance + kind
            parts.append(_message("A", struct.pack("<BH", instance, id) + name.encode()))
            for time, row in zip(1_000_000 + (1e6 * imu.time).astype(int), values, strict=True):
                samples.append((time, struct.pack("<HQQIffff", id, time + 150, time, 7, *row, 41.5)))
    samples.sort(key=lambda sample: sample[0])
    parts += [_message("D", content) for _, content in samples]
    if dropout_ms:
        parts.append(_message("O", struct.pack("<H", dropout_ms)))
    return b"".join(parts)


def _message(kind: str, content: bytes) -> bytes:
    return struct.pack("<HB", len(content), ord(kind)) + content


def cdr(time: float, force: Array, rate: Array, *, stamped: bool = True) -> bytes:
    """One message of sensor_msgs/msg/Imu."""
    types = STORE.types
    ns = START_NS + round(1e9 * time) if stamped else 0
    stamp = types["builtin_interfaces/msg/Time"](sec=ns // 10**9, nanosec=ns % 10**9)
    vector, nothing = types["geometry_msgs/msg/Vector3"], np.zeros(9)
    message = types["sensor_msgs/msg/Imu"](
        header=types["std_msgs/msg/Header"](stamp=stamp, frame_id="imu"),
        orientation=types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0),
        orientation_covariance=nothing,
        angular_velocity=vector(*rate),
        angular_velocity_covariance=nothing,
        linear_acceleration=vector(*force),
        linear_acceleration_covariance=nothing,
    )
    return bytes(STORE.serialize_cdr(message, "sensor_msgs/msg/Imu"))


def sent(found: list[Imu], *, stamped: bool = True) -> list[tuple[str, int, bytes]]:
    """Topic, time of the log and content of every message, in order."""
    messages = [
        (f"/imu{number}/data_raw", START_NS + round(1e9 * time), cdr(time, force, rate, stamped=stamped))
        for number, imu in enumerate(found)
        for time, force, rate in zip(imu.time, imu.force, imu.rate, strict=True)
    ]
    return sorted(messages, key=lambda message: message[1])


def mcap(found: list[Imu], **changes: bool) -> bytes:
    """A robot's recording, as `ros2 bag record -s mcap` makes it."""
    target = io.BytesIO()
    writer = McapWriter(target)
    writer.start("ros2", "test")
    schema = writer.register_schema("sensor_msgs/msg/Imu", "ros2msg", b"# of ROS")
    channels: dict[str, int] = {}
    for topic, at, content in sent(found, **changes):
        if topic not in channels:
            channels[topic] = writer.register_channel(topic, "cdr", schema)
        writer.add_message(channels[topic], at, content, at)
    writer.finish()
    return target.getvalue()


def bag(found: list[Imu], **changes: bool) -> bytes:
    """The messages in SQLite: the database of a rosbag2."""
    with TemporaryDirectory() as folder:
        with BagWriter(Path(folder) / "bag", version=9) as writer:
            connections = {}
            for topic, at, content in sent(found, **changes):
                if topic not in connections:
                    connections[topic] = writer.add_connection(topic, "sensor_msgs/msg/Imu", typestore=STORE)
                writer.write(connections[topic], at, content)
        return next((Path(folder) / "bag").glob("*.db3")).read_bytes()


WRITERS = {"ulog": ulog, "mcap": mcap, "bag": bag}
