"""Claims about a block that moves: ``python -m benchmarks.study.parity_reach --sessions 40 --seed 1``.

Flights of `tests.blind.flight`, drawn at random: sensors up to 5 cm apart, up to a sample late, shaken or not, at rest
for a while or never, places stated or not, gyros beside or not; every block once as it was calibrated and once with one
sensor changed by the size that the first check states as isolable, on the same path.
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from benchmarks.details import in_full
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from estimator import Calibration, ParityResult, calibrate, parity_check, read_session
from tests.blind.flight import Block, G, Setting, draw_block, fly, tumble
from tests.builders import gyro_block, true_sensors

KINDS = ("bias", "scale", "axis")
SECONDS = {True: 180.0, False: 120.0}
"""Length with rest and without, s: shorter than a flight, longer than what parity needs."""
COARSE = 4.0
"""Rounds of the Earth's rate in a count, in pulses: as coarse as the quantisation shows."""


@dataclass(frozen=True)
class Flown:
    """A block, sound and with one sensor changed."""

    setting: Setting
    sound: ParityResult
    sensor: str
    kind: str
    changed: ParityResult | None
    """Result for the changed sensor; None where no size is stated from which on the change is named."""
    size: float | None


def flown(seed: int, rest: bool) -> Flown:
    """One drawn block and its two recordings."""
    rng = np.random.default_rng([seed, rest])
    setting = Setting(
        seconds=SECONDS[rest], arm=rng.uniform(0, 0.05), delay=float(rng.uniform() < 0.7),
        vibration=float(rng.choice([0.02, 0.2, 1.0])), rest=rest,
        stated=bool(seed & 1), gyros=bool(seed & 2),
    )  # fmt: skip
    block = draw_block(rng, setting)
    known = calibrate(read_session(tumble(block, rng)), quadratic=False)
    sound = checked(block, setting, known, rng, seed)
    place, kind = int(rng.integers(len(block.bias))), KINDS[seed // 4 % 3]
    size = getattr(sound.sensors[place], kind).isolable
    changed = None if size is None else checked(block.changed(place, kind, size), setting, known, rng, seed)
    return Flown(setting, sound, f"A{place + 1}", kind, changed, size)


def checked(block: Block, setting: Setting, known: Calibration, rng: np.random.Generator, way: int) -> ParityResult:
    """A flight of the block beside its calibration; noise and vibration are drawn anew, the path is the same."""
    return parity_check(read_session(fly(block, setting, rng, way)), known)


def said(result: ParityResult) -> str:
    """The result in a word."""
    if result.isolated:
        return "named"
    if result.detected:
        return "changed"
    return "moving" if result.moving else "nothing"


def reach(flights: list[Flown]) -> str:
    """Table of the results for sound and for changed blocks, by the recording's content."""
    rows = []
    for rest in (True, False):
        for stated in (True, False):
            for gyros in (True, False):
                some = [
                    f for f in flights if (f.setting.rest, f.setting.stated, f.setting.gyros) == (rest, stated, gyros)
                ]
                rows.append((yes(rest), yes(stated), yes(gyros), *_counted(some)))
        rows.append((yes(rest), "all", "all", *_counted([f for f in flights if f.setting.rest == rest])))
    head = (
        "rest", "places", "gyros", "sound blocks", "a sensor named", "a change, no name", "moving too much to tell",
        "a change if motion did nothing", "changed by the isolable size", "named rightly", "wrongly", "that bias, mg",
    )  # fmt: skip
    return table(head, rows)


def yes(stated: bool) -> str:
    """A word for the table."""
    return "yes" if stated else "no"


def _counted(some: list[Flown]) -> Iterator[object]:
    """The figures of some flights."""
    words = [said(f.sound) for f in some]
    yield len(some)
    yield rate([word == "named" for word in words])
    yield words.count("changed")
    yield words.count("moving")
    yield sum(f.sound.p_value_unmoved < f.sound.false_alarm / 2 for f in some)
    named = [(f.changed.isolated, f.sensor) for f in some if f.changed is not None]
    yield len(named)
    yield rate([who == sensor for who, sensor in named])
    yield sum(who not in (None, sensor) for who, sensor in named)
    sizes = [s.bias.isolable for f in some for s in f.sound.sensors if s.bias.isolable is not None]
    yield f"{1e3 * float(np.median(sizes)) / G:.3g}" if sizes else "–"


def targets(flights: list[Flown]) -> str:
    """Targets for sound and for changed blocks, whatever the recording holds."""
    changed = [(f.changed.isolated, f.sensor) for f in flights if f.changed is not None]
    rows = [
        ("a sound block that moves: a sensor named", "≤ 1 %", rate([said(f.sound) == "named" for f in flights])),
        ("one sensor changed by the isolable size: named", "95 %", rate([who == sensor for who, sensor in changed])),
    ]
    return table(("figure", "target", "measured"), rows)


def isolable(flights: list[Flown]) -> str:
    """Whether the stated size is isolated, by kind."""
    rows = []
    for kind in KINDS:
        some = [f for f in flights if f.kind == kind]
        held = [f.changed.isolated == f.sensor for f in some if f.changed is not None]
        rows.append((kind, len(some), len(held), rate(held)))
    return table(("kind", "recordings", "a size is stated", "changed by it and named"), rows)


def counted(sessions: int, seed: int) -> str:
    """χ² of sound pulse gyros on the stand, by how they count and what the file says."""
    rows = []
    for runs_on in (True, False):
        for counter in ("free-running", "reset", None):
            p = [_stand_p_value(runs_on, counter, seed + k) for k in range(sessions)]
            low = [value < 0.01 for value in p]
            rows.append(
                ("free-running" if runs_on else "reset", counter or "not stated", rate(low), f"{np.median(p):.2f}")
            )
    return table(("pulses are counted", "the file says", "p below 1 %", "median p"), rows)


def _stand_p_value(runs_on: bool, counter: str | None, seed: int) -> float:
    """p-value of one session whose only noise is the counting."""
    rng = np.random.default_rng(seed)
    scale = COARSE / (7.292115e-5 * 100.0)
    document = gyro_block(sensors=true_sensors(6, prefix="G", scale=scale, bias=1e-5, tilt=1e-3, seed=seed), se=1e-9)
    document |= {"counter": counter}
    for sensor in document["sensors"]:
        sensor.pop("bias_repeatability_rad_s")
        exact = np.array(document["table"][sensor["name"]])
        begun = rng.uniform(0, 1, len(exact)) if runs_on else 0.5
        document["table"][sensor["name"]] = np.floor(exact + begun).tolist()
        document["table"][f"{sensor['name']}_se"] = [1e-6] * len(exact)
    return calibrate(read_session(document), quadratic=False).fit.p_value


def tables(sessions: int, seed: int) -> str:
    """Markdown: what is said, whether the isolable size holds, and pulse counters."""
    flights = [flown(seed * 10_000 + k, rest) for rest in (True, False) for k in range(sessions)]
    parts = [
        "### What is said of a block that moves", reach(flights),
        "### Whether the isolable size holds", isolable(flights),
        "### Pulse counters", counted(4 * sessions, seed),
    ]  # fmt: skip
    joined = "\n\n".join(parts)
    return f"{targets(flights)}\n\n{in_full(joined)}"


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study.parity_reach", description=__doc__)
    parser.add_argument("--sessions", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    print(tables(options.sessions, options.seed))


if __name__ == "__main__":
    main()
