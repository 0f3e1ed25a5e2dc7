"""KTH MIMU4444 (Carlsson, Skog, Jaldén, IEEE Sensors J. 2021): binary packets of eight IMUs on one board.

Four bytes of acknowledgement, then packets of 106 bytes, the last one often cut off, all big-endian: 0xAA, packet
number (uint16), payload length (uint8, 100), payload, checksum (uint16, the sum of the first 104 bytes). Payload:
clock (uint32, 64 MHz), then eight times six int16: ax ay az gx gy gz.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.convert.contract import Converter, Document
from benchmarks.convert.documents import PER_DEGREE, columns, session, triad
from benchmarks.convert.files import read_bytes, refuse
from estimator.applied_vector import STANDARD_GRAVITY
from estimator.errors import FormatError, Problem

LEADING = 4
"""Bytes before the first packet: the board's answer to the command that started it."""
PACKET = np.dtype(
    [
        ("mark", "u1"),
        ("number", ">u2"),
        ("length", "u1"),
        ("clock", ">u4"),
        ("values", ">i2", (8, 6)),
        ("checksum", ">u2"),
    ]
)
MARK, LENGTH = 0xAA, 100
"""First byte of a packet; bytes of its clock and values."""
CLOCK_HZ = 64e6
"""Ticks of the board's clock in a second."""
RATE_HZ = 62.5
"""Packets a second, as the data set states."""
NUMBERS = 65536
"""Packet numbers before they begin anew, every 17.5 minutes."""
TURNS = {"exp_1": 0, "exp_2": 0, "exp_3": 1, "exp_4": 2, "exp_6": 0, "exp_9": 1}
"""Number of times that packet numbers had begun anew before the published sessions, by the sessions before. Numbers run
on from session to session, so the first one is the time that the board has streamed since it was switched on; pauses
are not counted.
"""
COUNTS = 2048 / STANDARD_GRAVITY
"""Counts per m/s²: 2048 per g."""
GYRO_COUNTS = 16.4 * PER_DEGREE
"""Counts per rad/s: 16.4 per degree per second."""
TURNED = np.array([[0.0, -1, 0], [-1, 0, 0], [0, 0, -1]])
"""Axes of IMUs 2, 4, 6, 8 on the board."""
FILES = "one or more `….bin` streams of one board, oldest first"


def packets(path: Path) -> NDArray[np.void]:
    """The packets of a stream, each checked."""
    content = read_bytes(path)
    count = (len(content) - LEADING) // PACKET.itemsize
    if count < 1:
        raise refuse(path, "file", f"has {len(content)} bytes; not even one packet of {PACKET.itemsize}")
    found = np.frombuffer(content, dtype=PACKET, offset=LEADING, count=count)
    octets = np.frombuffer(content, dtype=np.uint8, offset=LEADING, count=count * PACKET.itemsize)
    sums = octets.reshape(count, PACKET.itemsize)[:, :-2].sum(axis=1, dtype=np.int64)
    right = (found["mark"] == MARK) & (found["length"] == LENGTH)
    right &= np.remainder(sums, 65536) == found["checksum"]
    if not right.all():
        bad = int(np.argmin(right))
        place = LEADING + bad * PACKET.itemsize
        raise refuse(path, "packet", f"at byte {place} is damaged: mark, length or checksum is wrong", row=bad + 1)
    return found


def lost(numbers: NDArray[np.uint16]) -> int:
    """Packets missing between the first and the last."""
    steps = np.remainder(np.diff(numbers.astype(np.int64)), NUMBERS)
    return int((steps - 1).sum())


def since_power_on(path: Path, first: int) -> float | None:
    """s, before the packet numbered ``first``; None of a stream that is none of the published ones."""
    turns = TURNS.get(path.name.split(".")[0])
    return None if turns is None else (turns * NUMBERS + first) / RATE_HZ


def sensors() -> list[Document]:
    """24 accelerometers, then 24 gyros."""
    axes = [TURNED if imu % 2 == 0 else np.eye(3) for imu in range(1, 9)]
    numbered = list(enumerate(axes, start=1))
    accelerometers = [s for k, e in numbered for s in triad(f"A{k}", COUNTS, "count", axes=e)]
    return accelerometers + [s for k, e in numbered for s in triad(f"G{k}", GYRO_COUNTS, "count", gyro=True, axes=e)]


def convert_one(path: Path) -> tuple[str, Document]:
    """One stream → one raw session."""
    found = packets(path)
    ticks = np.remainder(np.diff(found["clock"].astype(np.int64)), 2**32)
    time = np.concatenate([[0.0], np.cumsum(ticks)]) / CLOCK_HZ
    values = found["values"].astype(np.float64)
    readings = np.hstack([values[:, :, :3].reshape(len(found), 24), values[:, :, 3:].reshape(len(found), 24)])
    listed = sensors()
    notes = (
        f"KTH MIMU4444 recording {path.name}, packets {found['number'][0]} to {found['number'][-1]}, "
        f"{lost(found['number'])} lost; scale factors per standard g, the local g is not published"
    )
    document = session(
        "mimu4444",
        listed,
        {"time_s": time.tolist(), **columns(listed, readings)},
        gravity=STANDARD_GRAVITY,
        notes=notes,
        sample_rate_hz=RATE_HZ,
        time_since_power_on_s=since_power_on(path, int(found["number"][0])),
    )
    return f"kth-mimu-{path.name.split('.')[0]}.json", document


def convert(paths: list[Path]) -> list[tuple[str, Document]]:
    """Streams of one board → one raw session each: a history."""
    if not paths:
        raise FormatError([Problem("files", f"none given; name {FILES}")])
    return [convert_one(path) for path in paths]


KTH_MIMU = Converter(
    name="kth-mimu",
    description="Eight IMUs on one board: 24 accelerometers and 24 gyros, still orientations and motion.",
    files=FILES,
    convert=convert,
)
