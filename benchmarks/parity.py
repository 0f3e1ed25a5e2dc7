"""Every number of docs/methods/parity.md: ``python -m benchmarks.parity``."""

import resource
import sys
import time
from dataclasses import replace

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.orientations import GRAVITY, Case, axes_of, case, sphere
from benchmarks.parity_recordings import across_sessions, drift_curve, untouched
from benchmarks.recordings.sets import FOLDER, folder
from benchmarks.two_axis_stand import table
from estimator import Calibration, CalibrationSession, ParityAccumulator, ParityResult, Site, calibrate, parity_check
from estimator.parameters import SensorParameters
from estimator.parity.flight import AEROBATIC, TRANSPORT, Manoeuvre, Weather, fly
from estimator.results import ARCSEC
from estimator.session import Array
from estimator.simulate import cone

RUNS = 200
REST = (Manoeuvre(60.0, pitch=0.3, side=0.2),)
MICRO_G = 9.80665e-6
SITE = Site(gravity=GRAVITY)


def visible() -> Table:
    """Share of each sensor's change that parity sees, by block."""
    blocks = [("4, one up and three about it", axes_of(4)), ("5, likewise", axes_of(5)), ("6, likewise", axes_of(6))]
    blocks.append(("6 on a cone of 54.7°", cone(6, np.arccos(1 / np.sqrt(3)))))
    blocks.append(("24, eight triads", np.tile(np.eye(3), (8, 1))))
    rows: list[tuple[object, ...]] = []
    for name, axes in blocks:
        m = len(axes)
        share = 1 - np.diagonal(axes @ np.linalg.pinv(axes))
        rows.append((name, 4 * m, 12, 4 * (m - 3), f"{100 * share.min():.0f} to {100 * share.max():.0f} %"))
    columns = ("block", "numbers that can change", "never seen", "seen", "share of one sensor's change that shows")
    return table("What parity sees", columns, rows)


def reference(m: int, seed: int) -> tuple[Case, Calibration]:
    """A block and its calibration from 40 orientations."""
    rng = np.random.default_rng(seed)
    drawn = case(m, sphere(40, rng), rng)
    return drawn, calibrate(drawn.measured(rng), quadratic=False)


WEATHERS = {"white": Weather(), "wandering": Weather(wander=3e-4, wander_time=30.0)}


def false_alarms() -> Table:
    """Unchanged blocks in simulated flight."""
    rows: list[tuple[object, ...]] = []
    for m in (4, 6, 12):
        for kind in ("aerobatic", "transport", "rest"):
            for name, weather in WEATHERS.items():
                found = []
                for seed in range(RUNS // 2):
                    drawn, known = reference(m, seed)
                    rng = np.random.default_rng(10_000 + seed)
                    found.append(parity_check(flight(drawn, drawn.truth, rng, kind, weather), known, motion="any"))
                alarms = sum(r.detected for r in found)
                z = [s.bias.size / s.bias.sigma for r in found for s in r.sensors if s.bias.size is not None]
                limits = [limits_of(r) for r in found]
                rows.append(
                    (m, kind, name, f"{alarms} of {len(found)}", f"{np.sqrt(np.mean(np.square(z))):.2f}",
                     *(f"{x:.3g}" for x in np.median(limits, axis=0)))
                )  # fmt: skip
    columns = (
        "sensors",
        "flight",
        "noise",
        "false alarms",
        "rms of bias in sigmas",
        "bias, µg",
        "scale, ppm",
        "axis, ″",
    )
    return table("Unchanged blocks, 300 s of flight; size that is detected with 95 % power, at 1 %", columns, rows)


def limits_of(found: ParityResult) -> Array:
    """(3,) median over the sensors of the detectable size: µg, ppm, arcsec."""

    def typical(name: str) -> float:
        seen = [getattr(s, name).detectable for s in found.sensors]
        return float(np.median([np.nan if x is None else x for x in seen]))

    return np.array([typical("bias") / MICRO_G, 1e6 * typical("scale"), typical("axis") / ARCSEC])


def flight(
    drawn: Case, truth: SensorParameters, rng: np.random.Generator, kind: str, weather: Weather
) -> CalibrationSession:
    """A recording of a block."""
    manoeuvres = {"aerobatic": AEROBATIC, "transport": TRANSPORT, "rest": REST}[kind]
    return fly(drawn.schedule.sensors, truth, rng, manoeuvres=manoeuvres, seconds=300.0, weather=weather, site=SITE)


def detection() -> Table:
    """Share of drifts of one of six sensors that are detected, and attributed to it, over their size."""
    rows: list[tuple[object, ...]] = []
    for kind in ("aerobatic", "transport", "rest"):
        for part, sizes in (("bias, µg", (5, 10, 20, 40)), ("scale, ppm", (5, 10, 20, 40)), ("axis, ″", (1, 2, 4, 8))):
            rows.append((kind, part, *(rates(kind, part, size) for size in sizes)))
    columns = ("flight", "drift of", *(f"size {k}: found / isolated / wrong, %" for k in (1, 2, 3, 4)))
    return table("Six sensors, 300 s, white noise; sizes 5, 10, 20, 40 (axis 1, 2, 4, 8)", columns, rows)


def rates(kind: str, part: str, size: float) -> str:
    """Found, isolated, and attributed to another sensor, per cent."""
    found = []
    for seed in range(RUNS // 4):
        drawn, known = reference(6, seed)
        rng = np.random.default_rng(10_000 + seed)
        now = drifted(drawn.truth, seed % 6, part, size)
        found.append(parity_check(flight(drawn, now, rng, kind, WEATHERS["white"]), known, motion="any"))
    named = [f"A{seed % 6 + 1}" for seed in range(len(found))]
    right = sum(r.isolated == name for r, name in zip(found, named, strict=True))
    wrong = sum(r.isolated not in (None, name) for r, name in zip(found, named, strict=True))
    share = 100 / len(found)
    return f"{share * sum(r.detected for r in found):.0f} / {share * right:.0f} / {share * wrong:.0f}"


def drifted(truth: SensorParameters, sensor: int, part: str, size: float) -> SensorParameters:
    """One sensor changed; size in the unit of ``part``."""
    one = np.eye(len(truth.scale))[sensor]
    if part.startswith("bias"):
        return replace(truth, bias=truth.bias + size * MICRO_G * one)
    if part.startswith("scale"):
        return replace(truth, scale=truth.scale * (1 + 1e-6 * size * one))
    across = np.cross(truth.axis[sensor], [0.6, 0.0, 0.8])
    axes = truth.axis + one[:, None] * size * ARCSEC * across / np.linalg.norm(across)
    return replace(truth, axis=axes / np.linalg.norm(axes, axis=1, keepdims=True))


def hours() -> Table:
    """Time and memory of long streams, in this process."""
    drawn, known = reference(6, 0)
    session = fly(drawn.schedule.sensors, drawn.truth, np.random.default_rng(1), seconds=600.0, rate=100.0, site=SITE)
    rows: list[tuple[object, ...]] = []
    for length in (1, 4, 16):
        stream = ParityAccumulator("simulated", session.sensors, known, sample_rate=100.0, site=SITE)
        began, before = time.perf_counter(), peak()
        for _ in range(6 * length):
            stream.add(session.readings)
        result = stream.result()
        spent = time.perf_counter() - began
        rows.append((length, result.blocks, f"{result.block_seconds:.0f}", f"{spent:.2f}", f"{peak() - before:.0f}"))
    columns = ("hours at 100 Hz", "blocks kept", "s a block", "time, s", "peak memory on top, MB")
    return table("Long recordings, six sensors", columns, rows)


def peak() -> float:
    """Peak memory of this process, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def main() -> None:
    """Print every table."""
    console = Console(width=160)
    for made in (visible, hours, false_alarms, detection):
        console.print(made())
    if not folder().is_dir():
        print(f"The recordings are not at {folder()}; set {FOLDER} to their folder.", file=sys.stderr)
        return
    for made in (untouched, drift_curve, across_sessions):
        console.print(made())


if __name__ == "__main__":
    main()
