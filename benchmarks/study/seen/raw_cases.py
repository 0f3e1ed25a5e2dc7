"""Raw files of a block held still by hand, with what loggers do to them, in five formats."""

import io
import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from mcap.writer import Writer
from numpy.typing import NDArray
from rosbags.typesys import Stores, get_typestore
from scipy.io import savemat
from scipy.spatial.transform import Rotation

from service.ingest.layout.envelope import wrapped
from service.ingest.layout.look import look

Array = NDArray[Any]
Document = dict[str, Any]

GRAVITY = 9.81532
RATE = 100.0
"""Hz."""
RESTS, REST, TURN = 14, 3.5, 1.3
"""Number, s and s."""
NAMES = ("AX", "AY", "AZ", "GX", "GY", "GZ")
FELT, TURNED = [0, 1, 2], [3, 4, 5]
PER_G, PER_DEG_S = 16_384.0, 131.0
"""Counts, of an MPU-6050 at ±2 g and ±250 °/s."""
NOMINAL = np.array(3 * [PER_G / 9.80665] + 3 * [np.degrees(PER_DEG_S)])
"""Counts per m/s² and per rad/s."""
STORE = get_typestore(Stores.ROS2_HUMBLE)


@dataclass(frozen=True)
class World:
    """One block and what was recorded of it."""

    scale: Array
    """(6,) true over nominal scale factor."""
    bias: Array
    """(6,) m/s² and rad/s."""
    time: Array
    """(R,) s."""
    counts: Array
    """(R, 6) counts with their fractions; whole in files of counts."""
    position: Array
    """(R,) number of the rest, −1 between."""


@dataclass(frozen=True)
class Case:
    """Content of a raw file."""

    world: World
    rng: np.random.Generator
    values: Array
    """(R, 6) counts; NaN is an empty cell."""
    time: Array
    """(R,) s, as stated."""
    rate: float | None
    labelled: bool


def world(rng: np.random.Generator) -> World:
    """Rests in orientations at random, with turns by hand between them."""
    scale = 1 + np.r_[rng.normal(0, 0.01, 3), np.zeros(3)]
    bias = np.r_[rng.normal(0, 0.2, 3), rng.normal(0, 0.015, 3)]
    still, moving = round(REST * RATE), round(TURN * RATE)
    course = 0.5 - 0.5 * np.cos(np.pi * (np.arange(moving) + 0.5) / moving)
    turns, rates, place = [], [], []
    now = Rotation.random(random_state=rng)
    for k in range(RESTS):
        turn = rng.normal(0, 1, 3)
        turn *= rng.uniform(0.8, 2.2) / np.linalg.norm(turn)
        turns += [
            np.repeat(now.as_matrix()[None], still, 0),
            (now * Rotation.from_rotvec(course[:, None] * turn)).as_matrix(),
        ]
        speed = np.gradient(course) * RATE
        rates += [np.zeros((still, 3)), speed[:, None] * turn + 0.05 * rng.normal(0, 1, (moving, 3))]
        place += [np.full(still, k), np.full(moving, -1)]
        now = now * Rotation.from_rotvec(turn)
    up = np.concatenate(turns)[:, 2, :]
    hand = 0.4 * rng.normal(0, 1, up.shape) * (np.concatenate(place) < 0)[:, None]
    inputs = np.column_stack([GRAVITY * up + hand, np.concatenate(rates)])
    noise = np.r_[np.full(3, 0.02), np.full(3, 0.0012)] * rng.uniform(0.6, 1.5, 6)
    counts = NOMINAL * scale * (inputs + bias + noise * rng.normal(0, 1, inputs.shape))
    counts = np.clip(counts, -32767, 32766)
    return World(scale, bias, np.arange(len(counts)) / RATE, counts, np.concatenate(place))


Fault = Callable[[Case], Case]


def _rows(case: Case, share: float) -> Array:
    return np.flatnonzero(case.rng.random(len(case.values)) < share)


def _marked(value: float, channels: list[int], share: float) -> Fault:
    def fault(case: Case) -> Case:
        values = case.values.copy()
        values[np.ix_(_rows(case, share), channels)] = value
        return replace(case, values=values)

    return fault


def sign_lost(channels: list[int]) -> Fault:
    """Words read without their sign."""
    return lambda case: replace(
        case, values=np.where(_of(channels) & (case.values < 0), case.values + 65536, case.values)
    )


def _of(channels: list[int]) -> Array:
    return np.isin(np.arange(6), channels)


def zeros_between(case: Case) -> Case:
    """Every other message holds a rate only, and the others an acceleration."""
    values = case.values.copy()
    values[::2, :3], values[1::2, 3:] = 0.0, 0.0
    return replace(case, values=values)


def some_zero_vectors(case: Case) -> Case:
    """A dropped reading is written as zero."""
    values = case.values.copy()
    values[np.ix_(_rows(case, 0.07), TURNED)] = 0.0
    return replace(case, values=values)


def frozen(case: Case) -> Case:
    """One channel stands still over a rest or two, and the turn to it."""
    values, i = case.values.copy(), int(case.rng.integers(6))
    start = int(case.rng.integers(len(values) // 2))
    values[start : start + round(case.rng.uniform(1.5, 2.5) * (REST + TURN) * RATE), i] = values[start, i]
    return replace(case, values=values)


def polled(case: Case) -> Case:
    """The logger takes every reading three times."""
    latest = np.minimum.accumulate(np.arange(len(case.values))[::-1])[::-1]
    return replace(case, values=case.values[latest // 3 * 3])


def rolled_over(case: Case) -> Case:
    """A counter of 32 bits, in µs."""
    passes = 2.0**32 * 1e-6
    return replace(case, time=np.round(np.mod(case.time + passes - 20.0, passes), 6))


def restarted(case: Case) -> Case:
    """The logger starts anew on the way."""
    time, at = case.time.copy() + 100, len(case.time) // 2
    time[at:] -= time[at] - 0.3
    return replace(case, time=time)


def milliseconds(case: Case) -> Case:
    """Writes milliseconds under the name of seconds."""
    return replace(case, time=1e3 * case.time)


def no_rate(case: Case) -> Case:
    """Nobody says that the rows are samples."""
    return replace(case, rate=None, labelled=False)


def rounded_time(case: Case) -> Case:
    """Epoch seconds with six digits, and no rate."""
    return replace(case, rate=None, labelled=False, time=np.full(len(case.time), 1.73234e9))


def wild(case: Case) -> Case:
    """A few samples of every rest are anything."""
    values = case.values.copy()
    rows = _rows(case, 0.004)
    values[rows, case.rng.integers(6, size=len(rows))] = np.round(case.rng.uniform(-32000, 32000, len(rows)))
    return replace(case, values=values)


def doubled(case: Case) -> Case:
    """Rows written twice, with their time."""
    rows = np.sort(np.r_[np.arange(len(case.time)), _rows(case, 0.05)])
    place = replace(case.world, position=case.world.position[rows])
    return replace(case, world=place, values=case.values[rows], time=case.time[rows])


FAULTS: dict[str, Fault] = {
    "end of the range, all channels": _marked(-32768.0, FELT + TURNED, 0.003),
    "end of the range, gyros": _marked(32767.0, TURNED, 0.05),
    "-999": _marked(-999.0, [1], 0.02),
    "1e30": _marked(1e30, [2, 4], 0.01),
    "empty cells": _marked(np.nan, [0, 5], 0.03),
    "sign lost, gyros": sign_lost(TURNED),
    "sign lost, all": sign_lost(FELT + TURNED),
    "zeros between": zeros_between,
    "some zero vectors": some_zero_vectors,
    "frozen": frozen,
    "polled": polled,
    "clock rolls over": rolled_over,
    "clock restarts": restarted,
    "milliseconds": milliseconds,
    "no rate": no_rate,
    "no rate, rounded time": rounded_time,
    "wild samples": wild,
    "doubled rows": doubled,
}
"""Faults by name: sixteen kinds, two of them in two places."""


def sensors(unit_scale: bool) -> list[Document]:
    """The sensors as a file declares them, in counts or in SI."""
    return [
        {
            "name": name,
            "kind": "gyroscope" if name[0] == "G" else "accelerometer",
            "nominal_axis": np.eye(3)[i % 3].tolist(),
            "nominal_scale": 1.0 if unit_scale else float(NOMINAL[i]),
            "reading_unit": ("rad/s" if name[0] == "G" else "m/s²") if unit_scale else "count",
        }
        for i, name in enumerate(NAMES)
    ]


def metadata(case: Case) -> Document:
    """A session without its table."""
    document: Document = {
        "format": "imu-session/1", "unit": "RAW-1", "block": "accelerometer", "programme": "arbitrary-orientations",
        "started_at": "2026-03-01T09:00:00Z", "site": {"gravity_m_s2": GRAVITY}, "sensors": sensors(False),
    }  # fmt: skip
    return document if case.rate is None else document | {"sample_rate_hz": case.rate}


def columns(case: Case) -> dict[str, list[float | None]]:
    """Columns by name."""
    named = {"time_s": case.time, **dict(zip(NAMES, case.values.T, strict=True))}
    table = {name: [None if np.isnan(x) else float(x) for x in column] for name, column in named.items()}
    return table | ({"position": case.world.position.tolist()} if case.labelled else {})


def csv(table: dict[str, list[float | None]]) -> str:
    """Comma-separated, empty where nothing is known."""
    rows = zip(*table.values(), strict=True)
    lines = (",".join("" if cell is None else f"{cell:.12g}" for cell in row) for row in rows)
    return "\n".join([",".join(table), *lines]) + "\n"


def as_json(case: Case) -> bytes:
    """A session."""
    return json.dumps(metadata(case) | {"table": columns(case)}).encode()


def as_long_csv(case: Case) -> bytes:
    """A session, too."""
    return f"# {json.dumps(metadata(case))}\n{csv(columns(case))}".encode()


def as_own_table(case: Case) -> bytes:
    """A table of one's own with its mapping."""
    content = csv(columns(case)).replace("time_s", "t", 1)
    headings = content.partition("\n")[0].split(",")
    kept = {key: value for key, value in metadata(case).items() if key != "format"}
    mapped = [{"heading": name, "as": "time_s" if name == "t" else name} for name in headings]
    return wrapped({"format": "imu-mapping/1", "columns": mapped, "session": kept}, content.encode())


def as_mat(case: Case) -> bytes:
    """MATLAB's."""
    target = io.BytesIO()
    arrays = {name: np.array(cells, dtype=float) for name, cells in columns(case).items()}
    savemat(target, {"imu_session": json.dumps(metadata(case)), **arrays}, oned_as="column")
    return target.getvalue()


def _message(stamp: float, values: Array) -> bytes:
    types, ns = STORE.types, round(1e9 * stamp)
    vector, nothing = types["geometry_msgs/msg/Vector3"], np.zeros(9)
    message = types["sensor_msgs/msg/Imu"](
        header=types["std_msgs/msg/Header"](
            stamp=types["builtin_interfaces/msg/Time"](sec=ns // 10**9, nanosec=ns % 10**9), frame_id="imu"
        ),
        orientation=types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0),
        orientation_covariance=nothing,
        angular_velocity=vector(*values[3:]),
        angular_velocity_covariance=nothing,
        linear_acceleration=vector(*values[:3]),
        linear_acceleration_covariance=nothing,
    )
    return bytes(STORE.serialize_cdr(message, "sensor_msgs/msg/Imu"))


def as_mcap(case: Case) -> bytes:
    """A robot's log, in SI, with the mapping that its preview proposes."""
    target = io.BytesIO()
    writer = Writer(target)
    writer.start("ros2", "study")
    channel = writer.register_channel("/imu", "cdr", writer.register_schema("sensor_msgs/msg/Imu", "ros2msg", b"#"))
    begun = 1_780_000_000 * 10**9
    for at, stamp, row in zip(case.world.time, case.time, case.values / NOMINAL, strict=False):
        logged = begun + round(1e9 * at)
        writer.add_message(channel, logged, _message(stamp, row), logged)
    writer.finish()
    seen: Any = look(target.getvalue(), "log.mcap")
    mapped = [{"heading": column["heading"], "as": column["meaning"]} for column in seen["columns"]]
    stated = {**seen["facts"], "unit": "RAW-1", "site": {"gravity_m_s2": GRAVITY}}
    return wrapped({"format": "imu-mapping/1", "columns": mapped, "session": stated}, target.getvalue())


PATHS: dict[str, Callable[[Case], bytes]] = {
    "json": as_json,
    "long csv": as_long_csv,
    "own table": as_own_table,
    "mat": as_mat,
    "mcap": as_mcap,
}
NO_RATE = ("no rate", "no rate, rounded time", "milliseconds", "doubled rows")
"""Faults that a robot's log cannot have."""
