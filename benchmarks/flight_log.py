"""``python -m benchmarks.flight_log``: a vehicle with three IMUs, its rest before take-off as a check in service.

The nine accelerometers of the log are one unit. No calibration of theirs is public; the log's readings are those that
the autopilot has corrected, so that its own calibration says of each: scale 1, zero 0. That statement is uploaded as
the reference, a session of twenty directions simulated to it with the noise of one reading, and the minute at rest is
judged by it: whether the autopilot's calibration of nine sensors still agrees with itself, by parity.
"""

import json
import struct
import tempfile
from collections.abc import Iterator
from typing import Any

import httpx
import numpy as np

from benchmarks.convert.documents import Columns, columns, session, triad
from benchmarks.orientations import sphere
from benchmarks.recordings.sets import folder
from benchmarks.u2_uploads import serving

UNIT = "vehicle-171"
LOG = "ardupilot-three-imus/log171.bin"
HEAD, FORMAT, FORMAT_LENGTH = b"\xa3\x95", 128, 89
"""DataFlash: header of a message, type of the messages that describe the others, and their length in bytes."""
LETTERS = {"I": "I", "f": "f", "B": "B", "M": "B", "Q": "Q"}
"""Letters of DataFlash's formats → letters of `struct`, as far as messages of IMUs use them."""
IMUS = ("IMU", "IMU2", "IMU3")
REST, RATE = (22.0, 50.0), 49.1
"""s from the log's first reading, between the hands that set it down and its take-off, and Hz of its readings."""
DIRECTIONS, NOISE, GRAVITY = 20, 0.01, 9.80665
"""The reference: directions; one sigma of a reading, m/s²; gravity, m/s²."""


def messages(content: bytes) -> Iterator[tuple[str, tuple[float, ...]]]:
    """Name and numbers of every message of an IMU."""
    kinds: dict[int, tuple[int, str, str]] = {}
    at = content.find(HEAD)
    while 0 <= at < len(content) - FORMAT_LENGTH:
        kind = content[at + 2]
        if kind == FORMAT:
            own, length, name, form = struct.unpack("<BB4s16s", content[at + 3 : at + 25])
            kinds[own] = (length, name.strip(b"\0").decode(), form.strip(b"\0").decode())
            at += FORMAT_LENGTH
            continue
        length, name, form = kinds[kind]
        if name in IMUS:
            yield name, struct.unpack("<" + "".join(LETTERS[c] for c in form), content[at + 3 : at + length])
        at = content.find(HEAD, at + length)


def at_rest(content: bytes) -> Columns:
    """(R, 9) m/s², x, y, z of each IMU, of the rest before take-off."""
    rows: dict[str, list[tuple[float, ...]]] = {name: [] for name in IMUS}
    for name, numbers in messages(content):
        rows[name].append(numbers)
    count = min(map(len, rows.values()))
    force = np.hstack([np.array(rows[name])[:count, 4:7] for name in IMUS])
    first, last = (round(RATE * seconds) for seconds in REST)
    return force[first:last]


def documents() -> Iterator[dict[str, Any]]:
    """The reference, then the rest."""
    sensors = [sensor for k in range(1, 1 + len(IMUS)) for sensor in triad(f"A{k}", 1.0, "m/s²")]
    rng = np.random.default_rng(171)
    force = GRAVITY * sphere(DIRECTIONS, rng)
    stated = np.tile(force, len(IMUS)) + NOISE * rng.standard_normal((DIRECTIONS, 3 * len(IMUS)))
    notes = "the autopilot's own calibration: corrected readings, scale 1, zero 0"
    errors: dict[str, list[object]] = {f"{sensor['name']}_se": [NOISE] * DIRECTIONS for sensor in sensors}
    table = columns(sensors, stated) | errors
    yield session(UNIT, sensors, table, gravity=GRAVITY, notes=notes, started_at="2014-12-01T09:00:00Z")
    table = columns(sensors, at_rest((folder() / LOG).read_bytes()))
    more = {"programme": "in-service", "sample_rate_hz": RATE, "started_at": "2014-12-02T09:00:00Z"}
    yield session(UNIT, sensors, table, gravity=GRAVITY, notes="the rest before take-off", **more)


def main() -> None:
    """Prints the service's verdicts on both."""
    with (
        tempfile.TemporaryDirectory(prefix="imu-flight-", ignore_cleanup_errors=True) as name,
        serving(name) as port,
        httpx.Client(base_url=f"http://127.0.0.1:{port}/api/v1", timeout=120) as http,
    ):
        for document in documents():
            answer = http.post("/sessions", content=json.dumps(document).encode())
            said = answer.raise_for_status().json()
            print(f"{document['notes']}: {said['verdict']}: {said['reason']}")


if __name__ == "__main__":
    main()
