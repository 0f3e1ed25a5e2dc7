"""Faults put into recordings of a real array: ``python -m benchmarks.study.seen.real_arrays --n 100 --seed 1``.

Nine of the 24 accelerometers of the kth-mimu-array (three of its eight IMUs), calibrated by the rests of one session;
the recording is four minutes of another, rests and turns by hand. Every one is judged as it is and with a fault.
"""

import argparse
from dataclasses import replace
from functools import cache

import numpy as np

from benchmarks.parity_recordings import accelerometers, raw
from benchmarks.recordings.sets import FILES, folder, recordings
from benchmarks.study.rates import rate
from benchmarks.study.report import table as markdown
from benchmarks.study.seen.faults import KINDS, draw_fault
from benchmarks.study.seen.flight_generator import Fault, Flight, Unit
from benchmarks.study.seen.flights import seen
from estimator import Calibration, CalibrationSession, ParityResult, calibrate, parity_check
from estimator.session import IN_SERVICE

ARRAY = "kth-mimu"
SECONDS, LAST = 240.0, 500.0
"""s of a recording, and of a session before it is shaken by hand to the end of the range."""
IMUS = 3
NEAR = 3.0
"""s by which an onset may be off."""
LIMIT = 16 * 9.80665
"""m/s²"""


def of_sensors(session: CalibrationSession, chosen: tuple[int, ...]) -> CalibrationSession:
    """Some of the sensors, called A1, A2, …"""
    own = list(chosen)
    named = tuple(replace(session.sensors[k], name=f"A{place + 1}") for place, k in enumerate(own))
    return replace(
        session, sensors=named, readings=session.readings[:, own], standard_errors=session.standard_errors[:, own],
        at_ends=None if session.at_ends is None else session.at_ends[:, own],
    )  # fmt: skip


@cache
def known(session: int, chosen: tuple[int, ...]) -> Calibration:
    """The calibration of some sensors by the rests of a session."""
    return calibrate(of_sensors(accelerometers(recordings(ARRAY)[session].session), chosen))


def as_flight(recording: CalibrationSession) -> Flight:
    """The recording in the generator's terms, so that the same faults are put in."""
    m = len(recording.sensors)
    nothing = np.zeros(m)
    scale = np.array([s.nominal_scale for s in recording.sensors])
    unit = Unit(
        axes=np.array([s.nominal_axis for s in recording.sensors]), scale=scale, bias=nothing,
        position=np.zeros((m, 3)), delay=nothing, rectification=nothing, bending=np.zeros((m, 3)), warming=nothing,
        noise=nothing, count=1.0, limit=LIMIT,
    )  # fmt: skip
    assert recording.sample_rate is not None
    inputs = recording.readings / scale
    return Flight(unit, recording.sample_rate, inputs, np.zeros_like(inputs), np.zeros(len(inputs), dtype=bool))


def drawn(seed: int, k: int) -> tuple[CalibrationSession, Calibration, np.random.Generator]:
    """The k-th recording and its reference."""
    rng = np.random.default_rng([seed, k])
    reference, session = (int(i) for i in rng.choice(len(raw(ARRAY)), 2, replace=False))
    imus = sorted(int(i) for i in rng.choice(8, IMUS, replace=False))
    chosen = tuple(3 * imu + axis for imu in imus for axis in range(3))
    whole = raw(ARRAY)[session]
    assert whole.sample_rate is not None
    first = int(rng.uniform(0, LAST - SECONDS) * whole.sample_rate)
    rows = slice(first, first + int(SECONDS * whole.sample_rate))
    part = replace(
        whole, readings=whole.readings[rows], standard_errors=whole.standard_errors[rows], programme=IN_SERVICE,
        time=None if whole.time is None else whole.time[rows], position=None, temperature=None,
    )  # fmt: skip
    return of_sensors(part, chosen), known(reference, chosen), rng


def judged(recording: CalibrationSession, reference: Calibration, flight: Flight, fault: Fault,
           rng: np.random.Generator) -> ParityResult:  # fmt: skip
    """Parity's result on the recording with a fault."""
    return parity_check(replace(recording, readings=flight.readings((fault,), rng)), reference)


def table(n: int, seed: int) -> str:
    """Markdown; the reason, where the recordings are not there."""
    if not list(folder().glob(FILES[ARRAY])):
        return f"Not measured: {folder() / FILES[ARRAY]} is not there."
    found, named, missing = [], [], 0
    for k in range(n):
        recording, reference, rng = drawn(seed, k)
        named.append([fault.kind for fault in parity_check(recording, reference).faults])
        flight = as_flight(recording)
        try:
            fault = draw_fault(KINDS[k % len(KINDS)], flight, rng)
        except ValueError:
            missing += 1
            continue
        found.append(seen(fault, fault.since, judged(recording, reference, flight, fault, rng), near=NEAR))
    rows = []
    for kind in (*KINDS, "all"):
        some = [one for one in found if kind in (one.fault.kind, "all")]
        rows.append((
            kind, rate([one.noticed for one in some]), rate([one.sensor for one in some]),
            rate([one.near for one in some]), rate([one.kind for one in some]),
            ", ".join(sorted({one.said for one in some if not one.kind})) or "–",
        ))  # fmt: skip
    head = ("fault", "noticed", "its sensor", "onset within 3 s", "its kind", "else called")
    listed = ", ".join(sorted({kind for kinds in named for kind in kinds})) or "none"
    return f"{markdown(head, rows)}\n\nAs recorded, named: {rate([bool(kinds) for kinds in named])} ({listed})."


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study.seen.real_arrays", description=__doc__)
    parser.add_argument("--n", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    print(table(options.n, options.seed))


if __name__ == "__main__":
    main()
