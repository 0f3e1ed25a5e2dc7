"""Faults that begin in flight: ``python -m benchmarks.study.seen.flights --n 300 --seed 1`` prints a table.

Blocks of five to eight accelerometers (`flight_generator`), each flown once sound and once with a fault of one of ten
kinds (`faults`), of 5 to 500 standard errors of a one-second mean of that sensor as it lies in parity.
"""

import argparse
from dataclasses import dataclass

import numpy as np

from benchmarks.study.rates import rate
from benchmarks.study.report import table as markdown
from benchmarks.study.seen.faults import KINDS, draw_fault
from benchmarks.study.seen.flight_generator import Fault, Flight, draw_flight, recorded, tumble
from estimator import Calibration, ParityResult, ScheduleError, calibrate, parity_check, read_session

SENSORS = (5, 6, 7, 8)
NEAR = 2.0
"""s by which an onset may be off."""


@dataclass(frozen=True)
class Seen:
    """One fault and what is said of it."""

    fault: Fault
    noticed: bool
    sensor: bool
    near: bool
    kind: bool
    others: int
    """Faults named beside it."""
    said: str


@dataclass(frozen=True)
class Sound:
    """A sound flight: what begins in it, by what is said, and whether a change is called."""

    named: tuple[str, ...]
    detected: bool


def judged(flight: Flight, known: Calibration, faults: tuple[Fault, ...], rng: np.random.Generator) -> ParityResult:
    """Parity's result for a flight with faults."""
    return parity_check(read_session(recorded(flight, flight.readings(faults, rng))), known)


def seen(fault: Fault, since: float, result: ParityResult, *, near: float = NEAR) -> Seen:
    """Compares the first fault that is named, of the right sensor if there is one, with the one put in."""
    names = {f"A{k + 1}" for k in (fault.sensor, fault.other) if k is not None}
    mine = [said for said in result.faults if said.sensor in names] or list(result.faults)
    if not mine:
        return Seen(fault, False, False, False, False, 0, "nothing")
    said = mine[0]
    return Seen(
        fault, True, said.sensor in names, abs(said.since - since) <= near, said.kind == fault.kind,
        len(result.faults) - 1, said.kind,
    )  # fmt: skip


def flown(seed: int, k: int) -> tuple[Sound, Seen | None]:
    """The k-th block; no fault where none of the kind would show in its flight."""
    rng = np.random.default_rng([seed, k])
    flight = draw_flight(int(rng.choice(SENSORS)), rng)
    known = calibrate(read_session(tumble(flight.unit, rng)), quadratic=False)
    sound = judged(flight, known, (), rng)
    quiet = Sound(tuple(fault.kind for fault in sound.faults), sound.detected)
    try:
        fault = draw_fault(KINDS[k % len(KINDS)], flight, rng)
    except ValueError:
        return quiet, None
    try:
        result = judged(flight, known, (fault,), rng)
    except ScheduleError:
        return quiet, Seen(fault, False, False, False, False, 0, "refused")
    return quiet, seen(fault, flight.since_in_rows(fault.since), result)


def table(n: int, seed: int) -> str:
    """Markdown: what was seen of n faults, kind by kind, and what was named in n sound flights."""
    flights = [flown(seed, k) for k in range(n)]
    found = [one for _, one in flights if one is not None]
    sounds = [sound for sound, _ in flights]
    rows = [(kind, *_row([one for one in found if one.fault.kind == kind])) for kind in KINDS]
    head = ("fault", "noticed", "its sensor", "onset within 2 s", "its kind", "another named beside it", "else called")
    named = ", ".join(sorted({kind for sound in sounds for kind in sound.named})) or "none"
    quiet = (
        f"Sound flights in which anything was named: {rate([bool(s.named) for s in sounds])}"
        f" ({named}); called changed: {rate([s.detected for s in sounds])}."
    )
    return f"{markdown(head, [*rows, ('all', *_row(found))])}\n\n{quiet}"


def _row(some: list[Seen]) -> tuple[object, ...]:
    wrong = sorted({one.said for one in some if not one.kind})
    return (
        rate([one.noticed for one in some]), rate([one.sensor for one in some]), rate([one.near for one in some]),
        rate([one.kind for one in some]), sum(one.others > 0 for one in some), ", ".join(wrong) or "–",
    )  # fmt: skip


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study.seen.flights", description=__doc__)
    parser.add_argument("--n", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    print(table(options.n, options.seed))


if __name__ == "__main__":
    main()
