"""Parity on two real arrays: 24 accelerometers on one board, and fifteen of five IMUs moved together.

Their sensors do not sit in one point, so only rest is used. A session is dealt into two halves, rest by rest: one half
calibrates, the other is the recording. Into that a drift of one sensor is put, sensor after sensor.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from rich.table import Table
from scipy.linalg import null_space

from benchmarks.convert import convert
from benchmarks.recordings.held_out import rows as some_rows
from benchmarks.recordings.sets import FILES, folder, recordings
from benchmarks.two_axis_stand import table
from estimator import Calibration, CalibrationSession, calibrate, parity_check, read_session
from estimator.session import ACCELEROMETER, IN_SERVICE, Array

MILLI_G = 9.80665e-3
BIASES = (0.2, 0.5, 1.0, 2.0, 5.0)
"""mg"""
SCALES = (300.0, 1000.0, 3000.0)
"""ppm"""
TRIED = 5
"""Sensors of each half that a drift is put into."""


@dataclass(frozen=True, eq=False)
class Half:
    """One half of a session as the reference, the other as a recording in service."""

    name: str
    known: Calibration
    recording: CalibrationSession


def accelerometers(session: CalibrationSession) -> CalibrationSession:
    """The session without the gyros, whose scale rest does not show."""
    own = [k for k, s in enumerate(session.sensors) if s.kind == ACCELEROMETER]
    return replace(
        session,
        sensors=tuple(session.sensors[k] for k in own),
        readings=session.readings[:, own],
        standard_errors=session.standard_errors[:, own],
    )


@cache
def raw(format_name: str) -> tuple[CalibrationSession, ...]:
    """The sessions sample by sample, oldest first."""
    found = convert(format_name, sorted(folder().glob(FILES[format_name])))
    return tuple(accelerometers(read_session(document)) for _, document in found)


@cache
def halves() -> tuple[Half, ...]:
    """Every session of both arrays, halved both ways."""
    return tuple(of_board()) + tuple(of_five())


def of_board() -> Iterator[Half]:
    """kth-mimu: samples of the rests that took no part."""
    for whole, samples in zip(recordings("kth-mimu"), raw("kth-mimu"), strict=True):
        rests = accelerometers(whole.session)
        assert rests.time is not None
        assert samples.time is not None
        nearest = np.searchsorted((rests.time[1:] + rests.time[:-1]) / 2, samples.time)
        until = samples.time < rests.time[-1] + 12.0
        for k in (0, 1):
            own = np.arange(len(rests.readings)) % 2 == k
            part = some_rows(samples, ~own[nearest] & until)
            yield Half(f"{whole.name} {'ab'[k]}", calibrate(some_rows(rests, own)), replace(part, programme=IN_SERVICE))


def of_five() -> Iterator[Half]:
    """mpu9150-five: averages of the rests that took no part; the logs' samples cannot be paired."""
    whole = recordings("mpu9150-five")[-1]
    for k in (0, 1):
        own = np.arange(len(whole.session.readings)) % 2 == k
        known = calibrate(some_rows(whole.session, own), quadratic=False)
        yield Half(f"{whole.name} {'ab'[k]}", known, replace(some_rows(whole.session, ~own), programme=IN_SERVICE))


def untouched() -> Table:
    """The recordings as they are."""
    rows: list[tuple[object, ...]] = []
    for half in halves():
        r = parity_check(half.recording, half.known, motion="still")
        bias = np.median([s.bias.detectable or np.nan for s in r.sensors]) / MILLI_G
        scale = 1e6 * np.median([s.scale.detectable or np.nan for s in r.sensors])
        rows.append((half.name, len(r.sensors), r.used, r.left_out["moving"], r.groups, f"{r.chi2:.0f} of {r.dof}",
                     f"{r.p_value:.2f}", "yes" if r.detected else "no", f"{bias:.2f}", f"{scale:.0f}"))  # fmt: skip
    columns = ("half", "sensors", "blocks at rest", "moving", "groups", "χ²", "p", "alarm", "bias, mg", "scale, ppm")
    return table("Real recordings, untouched; typical drift that is detected with 95 % power", columns, rows)


def with_drift(half: Half, sensor: int, bias: float, scale: float) -> CalibrationSession:
    """A drift of one sensor: bias mg, scale ppm."""
    moved = half.recording.readings.copy()
    K = half.known.sensors[sensor].scale.value or 1.0
    moved[:, sensor] += K * bias * MILLI_G + 1e-6 * scale * moved[:, sensor]
    return replace(half.recording, readings=moved)


def drift_curve() -> Table:
    """Share of drifts found, isolated and attributed to another sensor."""
    rows: list[tuple[object, ...]] = []
    sizes = [(f"bias {b:g} mg", b, 0.0) for b in BIASES] + [(f"scale {s:g} ppm", 0.0, s) for s in SCALES]
    for name, group in by_session().items():
        for label, bias, scale in sizes:
            found, right, wrong, tried = 0, 0, 0, 0
            for half in group:
                m = len(half.known.sensors)
                for sensor in np.linspace(0, m - 1, TRIED).astype(int):
                    r = parity_check(with_drift(half, int(sensor), bias, scale), half.known, motion="still")
                    own = half.known.sensors[sensor].name
                    tried += 1
                    found += r.detected
                    right += r.isolated == own
                    wrong += r.isolated not in (None, own)
            rows.append((name, label, tried, *(f"{100 * n / tried:.0f} %" for n in (found, right, wrong))))
    columns = ("session", "drift put in", "tried", "found", "attributed to its sensor", "attributed to another")
    return table("A drift put into real recordings", columns, rows)


def by_session() -> dict[str, list[Half]]:
    """The halves of each session."""
    found: dict[str, list[Half]] = {}
    for half in halves():
        found.setdefault(half.name[:-2], []).append(half)
    return found


def across_sessions() -> Table:
    """A session beside the calibration of another: what parity finds, and what calibrating both says."""
    known = [calibrate(accelerometers(r.session)) for r in recordings("kth-mimu")]
    names = [r.name for r in recordings("kth-mimu")]
    rows: list[tuple[object, ...]] = []
    for i, j in ((0, 1), (1, 0), (1, 2), (2, 1)):
        r = parity_check(replace(raw("kth-mimu")[j], programme=IN_SERVICE), known[i], motion="still")
        found, expected = np.vstack([r.constant, MILLI_G * 1e3 * r.slope.T]), between(known[i], known[j])
        answers = ("yes" if answer else "no" for answer in (r.detected, r.explained))
        rows.append((f"{names[j]} by {names[i]}", f"{r.p_value:.1e}", *answers,
                     *(f"{rms(x[0]) / MILLI_G:.2f}" for x in (found, expected)),
                     f"{np.corrcoef(found[0], expected[0])[0, 1]:.3f}",
                     f"{np.corrcoef(found[1:].ravel(), expected[1:].ravel())[0, 1]:.3f}"))  # fmt: skip
    columns = ("recording by reference", "p", "change", "one sensor explains it",
               "bias by parity, mg", "by calibrating, mg", "correlation of biases", "of scales and axes")  # fmt: skip
    return table("Sessions of one board: change of bias in parity space, rms", columns, rows)


def between(first: Calibration, second: Calibration) -> Array:
    """(4, d) change from one calibration to another as parity sees it, in the parity space of the first."""
    axes = np.stack([np.asarray(s.axis) for s in first.sensors])
    V = null_space(axes.T)
    rows = []
    for a, b in zip(first.sensors, second.sensors, strict=True):
        gain = (b.scale.value or 1.0) / (a.scale.value or 1.0)
        bias = gain * (b.bias.value or 0.0) - (a.bias.value or 0.0)
        rows.append([bias, *(gain * np.asarray(b.axis) - np.asarray(a.axis)) * MILLI_G * 1e3])
    return np.asarray(V.T @ np.array(rows)).T


def rms(values: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))
