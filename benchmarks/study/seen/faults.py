"""Faults that are put into a recording: which sensor, kind, moment and size."""

import numpy as np

from benchmarks.study.seen.flight_generator import Fault, Flight

KINDS = ("step", "ramp", "stuck", "zero", "full-scale", "gain", "noise", "delay", "exchanged", "intermittent")
LEAST = 5.0
"""Standard errors of a one-second mean of the sensor as it lies in parity."""
FIRST, LAST = 3.0, 4.0
"""s that a recording holds before the earliest onset and after the latest."""
THROUGHOUT = 0.15
"""Share of the dead and exchanged that are so from the first sample."""
MOST_RAMP = 0.3
"""Largest ramp, as a share of the range, at the end of a recording."""
LONGEST_DELAY = 0.4
"""s"""


def draw_fault(kind: str, flight: Flight, rng: np.random.Generator, *, but: int | None = None) -> Fault:
    """One of a kind, large enough."""
    m, seconds = flight.inputs.shape[1], len(flight.inputs) / flight.rate
    for _ in range(200):
        sensor = int(rng.choice([i for i in range(m) if i != but]))
        since = float(rng.uniform(FIRST, seconds - LAST))
        if kind in ("stuck", "zero", "full-scale", "exchanged") and rng.uniform() < THROUGHOUT:
            since = 0.0
        fault = _of_size(kind, sensor, since, flight, rng)
        if fault is not None:
            return fault
    raise ValueError(f"no {kind} shows in this flight")


def _of_size(kind: str, sensor: int, since: float, flight: Flight, rng: np.random.Generator) -> Fault | None:
    se = flight.standard_error(sensor)
    strength, sign = se * LEAST * 10 ** rng.uniform(0, 2), float(rng.choice([-1, 1]))
    later = slice(round(since * flight.rate), None)
    felt = flight.inputs[later, sensor] + flight.unit.bias[sensor]
    if kind == "step":
        return Fault(sensor, kind, since, sign * strength)
    if kind == "ramp":
        steepest = MOST_RAMP * flight.unit.limit / (len(flight.inputs) / flight.rate - since)
        return Fault(sensor, kind, since, sign * min(strength / LEAST, steepest))
    if kind == "gain":
        size = strength / float(np.sqrt(np.mean(felt**2)))
        return Fault(sensor, kind, since, sign * size) if size < 1 else None
    if kind == "noise":
        own = float(np.std(np.diff(flight.inputs[:, sensor] + flight.noise[:, sensor]))) / np.sqrt(2)
        return Fault(sensor, kind, since, own * rng.uniform(2, 30))
    if kind == "intermittent":
        return _spells(sensor, since, sign * strength, flight, rng)
    if kind == "delay":
        size = float(rng.uniform(3 / flight.rate, LONGEST_DELAY))
        shift = size * np.gradient(_seconds(felt, flight.rate))
        return Fault(sensor, kind, since, size) if np.sqrt(np.mean(shift**2)) > LEAST * se else None
    if kind == "exchanged":
        other = int(rng.choice([i for i in range(flight.inputs.shape[1]) if i != sensor]))
        apart = _seconds(felt - flight.inputs[later, other], flight.rate)
        enough = np.sqrt(np.mean(apart**2)) > LEAST * se
        return Fault(sensor, kind, since, other=other) if enough else None
    return Fault(sensor, kind, since, sign)


def _seconds(course: np.ndarray, rate: float) -> np.ndarray:
    n = int(rate)
    return np.asarray(course[: len(course) // n * n].reshape(-1, n).mean(axis=1))


def _spells(sensor: int, since: float, size: float, flight: Flight, rng: np.random.Generator) -> Fault | None:
    """Comes twice at least, for some seconds each."""
    end, at = len(flight.inputs) / flight.rate, since
    spells = []
    while at < end - 3.0:
        long = rng.uniform(2, 8)
        spells.append((at, at + long))
        at += long + rng.uniform(2, 10)
    return Fault(sensor, "intermittent", since, size, spells=tuple(spells)) if len(spells) > 1 else None
