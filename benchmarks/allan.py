"""Terms of noise at rest against known truth, and of a recording: ``python -m benchmarks.allan [records]``.

The truth is made by `tests.estimator.allan.noises`, which shares no code with the estimator. Of every world: in how
many records a term is decided, in how many of these its 95 % interval holds the truth, and by how much decided sizes
are off on average; then, over all records, how often an interval was stated that does not hold it.
"""

import sys
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.recordings.sets import folder
from estimator.allan.estimate import allan_terms
from estimator.allan.rests import Rests
from estimator.allan.results import TERMS, SensorNoise
from estimator.session import ACCELEROMETER, GYROSCOPE, Array, Sensor
from service.sessions.words.noise import size_in_words
from tests.estimator.allan.noises import noise

INTERVAL = 0.01
RECORDS = 200
SIZES = {"rounded": "quantisation", "white": "white-noise", "flicker": "bias-instability", "walk": "random-walk"}
LSB = {GYROSCOPE: np.radians(0.05), ACCELEROMETER: 0.00333 * 9.80665}
"""rad/s and m/s² of a count of the ADIS16405."""


@dataclass(frozen=True)
class World:
    """The truth of records of one kind."""

    seconds: int
    rests: int
    sizes: dict[str, float]


WORLDS = (
    World(1000, 1, {"white": 1.0}),
    World(1000, 1, {"white": 1.0, "rounded": 0.1}),
    World(1000, 1, {"white": 1.0, "flicker": 0.3}),
    World(1000, 1, {"white": 1.0, "walk": 0.1}),
    World(4000, 1, {"white": 1.0, "flicker": 0.5}),
    World(4000, 1, {"white": 1.0, "walk": 0.1, "rounded": 0.02}),
    World(4000, 1, {"white": 1.0, "flicker": 0.5, "walk": 0.1}),
    World(2000, 1, {"white": 1.0, "flicker": 0.2, "walk": 0.02}),
    World(400, 20, {"white": 1.0, "flicker": 0.3}),
)


def sensor(name: str, kind: str = ACCELEROMETER) -> Sensor:
    """A sensor that reads SI."""
    return Sensor(name, kind, np.array([1.0, 0.0, 0.0]), 1.0, "SI")


def records(world: World, count: int, seed: int) -> list[SensorNoise]:
    """The noise found in so many records, one after another, each with its own rests."""
    rng = np.random.default_rng(seed)
    found: list[Any] = []
    for _ in range(count):
        y = noise(round(world.seconds / INTERVAL), INTERVAL, rng, **world.sizes)[:, None]
        result = allan_terms(Rests((sensor("y"),), tuple(np.split(y, world.rests)), INTERVAL))
        assert result is not None
        found += result.sensors
    return found


def rows(world: World, found: list[SensorNoise]) -> tuple[list[str], int, int]:
    """A line a term that is there or was decided; how many intervals were stated, and how many miss the truth."""
    lines, stated, wrong = [], 0, 0
    made = {SIZES[name]: size for name, size in world.sizes.items()}
    label = ", ".join(f"{size:g} {name}" for name, size in made.items())
    for name in TERMS:
        truth = made.get(name, 0.0)
        terms = [one.term(name) for one in found if one.term(name).value is not None]
        if not terms and not truth:
            continue
        intervals = [interval for term in terms if (interval := term.interval()) is not None]
        held = sum(low <= truth <= high for low, high in intervals)
        stated, wrong = stated + len(intervals), wrong + len(intervals) - held
        values = [term.value for term in terms if term.value is not None]
        off = f"{100 * (np.mean(values) / truth - 1):+.1f} %" if values and truth else ""
        share = f"{held} of {len(terms)}" if terms else ""
        place = f"{world.seconds} s in {world.rests}" if world.rests > 1 else f"{world.seconds} s"
        lines.append(f"| {place} | {label} | {name} | {len(terms)} of {len(found)} | {share} | {off} |")
    return lines, stated, wrong


def recorded() -> list[str]:
    """The terms of the public static recording, a line a sensor."""
    counts: Array = np.load(folder() / "adis16405-static" / "adis16405_run1.npz")["counts"].astype(float)
    kinds = [GYROSCOPE] * 3 + [ACCELEROMETER] * 3
    sensors = tuple(sensor(f"{kind} {axis}", kind) for kind, axis in zip(kinds, "xyzxyz", strict=True))
    result = allan_terms(Rests(sensors, (counts * [LSB[kind] for kind in kinds],), INTERVAL))
    assert result is not None
    return [_line(one) for one in result.sensors]


def _line(one: SensorNoise) -> str:
    cells = (size_in_words(one.kind, term.name, term.value, term.sigma) for term in one.terms)
    holds = "" if one.holds is None else f"{one.holds[0]:g} to {one.holds[1]:g} s"
    return f"| {one.name} | {holds} | {' | '.join(cells)} |"


HEAD = """# Noise at rest: every record

Printed by `python -m benchmarks.allan` (100 Hz; sizes in units of the white noise), then a public static recording of
an ADIS16405.
"""


def main(count: int) -> None:
    """Prints both tables."""
    print(HEAD)
    print("| record | truth | term | decided | interval holds it | decided sizes are off by |")
    print("| --- | --- | --- | --- | --- | --- |")
    stated = wrong = 0
    for seed, world in enumerate(WORLDS):
        lines, more, amiss = rows(world, records(world, count, seed))
        stated, wrong = stated + more, wrong + amiss
        print("\n".join(lines), flush=True)
    print(f"\nOf {stated} stated intervals {wrong} do not hold the truth: {100 * wrong / stated:.1f} %.\n")
    print(f"| sensor | holds | {' | '.join(TERMS)} |\n| --- | --- | --- | --- | --- | --- |")
    print("\n".join(recorded()))


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else RECORDS)
