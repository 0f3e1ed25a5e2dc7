"""The units of a life: what stands on each bench, and the session files that it gives."""

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tests.builders import accelerometer_block, arbitrary_orientations, mixed_block, raw_log, true_sensors
from tests.lives.generator.life import Sensors, draw_life, draw_type
from tests.lives.generator.sessions import draw_block, session_of
from tests.lives.generator.workshop import draw_stands
from tests.service.recordings import recording_document
from tests.service.turntable import alignment_bytes, rate_table_bytes

Document = dict[str, Any]
Make = Callable[[int], Document]
"""The session file of a number: the same number, the same file."""


@dataclass(frozen=True)
class Bench:
    """One unit, and what may be measured of it."""

    serial: str
    programmes: dict[str, Make]


def benches(seed: int) -> dict[str, Bench]:
    """Units of every programme, whose lives follow from a seed."""
    rng = np.random.default_rng(seed)
    made = [
        _lived("LV-101", "accelerometers", seed, rng),
        _lived("LV-102", "accelerometers", seed, rng),
        _lived("LV-240", "both", seed, rng),
        _separate("LV-350", seed, rng),
        Bench("HM-460", {"arbitrary-orientations": _dated(_by_hand, "HM-460")}),
        Bench("RA-570", {"rotation-alignment": _aligned, "rate-table": _turned}),
        Bench("LG-680", {"raw-log": _dated(lambda n: raw_log(seed=n), "LG-680")}),
        Bench("FL-790", {"two-axis-stand": _dated(_flown_unit, "FL-790"), "in-service": _flown}),
        Bench("MX-890", {"two-axis-stand": _dated(lambda _: mixed_block(), "MX-890")}),
    ]
    return {bench.serial: bench for bench in made}


def day(number: int) -> str:
    """Moment at which the session of a number was measured: 45 days after the one before, at different hours."""
    return str(np.datetime64("2022-01-10T08:00:00") + np.timedelta64(45 * number * 24 + number % 9, "h")) + "Z"


def _lived(serial: str, sensors: Sensors, seed: int, rng: np.random.Generator) -> Bench:
    type_ = draw_type(1 if sensors == "accelerometers" else 2, sensors, rng)
    return Bench(serial, {"two-axis-stand": _life(serial, type_, seed, rng)})


def _separate(serial: str, seed: int, rng: np.random.Generator) -> Bench:
    """Accelerometers and gyros of one unit, measured apart."""
    blocks: tuple[Sensors, Sensors] = ("accelerometers", "gyros")
    made = [_life(serial, draw_type(3, block, rng), seed, rng) for block in blocks]
    return Bench(serial, dict(zip(("accelerometers", "gyros"), made, strict=True)))


def _life(serial: str, type_: Any, seed: int, rng: np.random.Generator) -> Make:
    life = draw_life(serial, type_, rng, stands=draw_stands(rng))
    block = draw_block(life, rng)

    def make(number: int) -> Document:
        own = np.random.default_rng((seed, number))
        round_, place = divmod(number, len(life.sessions))
        measured = life.sessions[place]
        return session_of(life, block, replace(measured, day=min(measured.day + round_, 7000)), own)

    return make


def _dated(make: Make, serial: str) -> Make:
    return lambda number: make(number) | {"unit": serial, "started_at": day(number)}


def _by_hand(number: int) -> Document:
    return arbitrary_orientations(seed=number + 1, direction_sigma_deg=0.01 if number % 2 else None)


def _flown_unit(number: int) -> Document:
    sensors = true_sensors(6, bias=1e-3, quadratic=1e-6, tilt=1e-4)
    return accelerometer_block(6, seed=number + 1, sensors=sensors)


def _flown(number: int) -> Document:
    moved = 400.0 if number % 3 == 2 else 0.0
    document = recording_document(seed=number, unit="FL-790", seconds=60, a3_moved=moved)
    return document | {"started_at": day(number)}


def _aligned(number: int) -> Document:
    found: Document = json.loads(alignment_bytes(seed=number + 1, unit="RA-570"))
    return found | {"started_at": day(number)}


def _turned(number: int) -> Document:
    found: Document = json.loads(rate_table_bytes(seed=number + 1, unit="RA-570"))
    return found | {"started_at": day(number)}
