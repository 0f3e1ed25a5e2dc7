"""How near the gyros of simulated hands come to the Cramér–Rao bound, and how often their intervals hold."""

from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from benchmarks.hands.known_noise import known_noise
from benchmarks.hands.world import Array, Truth, World, simulated
from estimator import Calibration, calibrate
from estimator.session import CalibrationSession, RawRests
from estimator.static import labelled

ELEMENTS = ("scale", "bias", "axis_1", "axis_2")


@dataclass(frozen=True, eq=False)
class Tried:
    """One simulated log calibrated. m gyros."""

    error: Array
    """(m, 4) in SI."""
    sigma: Array
    """(m, 4) as stated."""
    reach: Array
    """(m, 4) coverage factors."""
    bound: Array
    """(m, 4) Cramér–Rao."""
    squared: float
    """Normalised error squared of all parameters together."""
    times: float
    """Speed in real times."""


def of_gyros(found: Calibration) -> tuple[Array, Array, list[int]]:
    """Sigma (m, 4) of the gyros, covariance of all their parameters, and their places in it."""
    at = [i for i, name in enumerate(found.names) if name[0] == "G" and name.split(".")[1] in ELEMENTS]
    covariance = found.covariance[np.ix_(at, at)]
    return np.sqrt(np.diagonal(covariance)).reshape(-1, 4), covariance, at


def bound(truth: Truth) -> Array:
    """(m, 4) sigma by the inverse information of the same rests and turns at the truth, under the true noise; that it
    is the bound, a test holds by brute force."""
    world, session = truth.world, truth.session
    rests = labelled(truth.labels)
    noise = np.repeat([world.accelerometer_noise, world.gyro_noise], [3, world.gyros])
    noise = np.hypot(noise, np.repeat(world.quantum[::-1], [3, world.gyros]) / 12**0.5)
    rows: CalibrationSession = replace(
        session, readings=rests.means(truth.clean), standard_errors=noise / np.sqrt(rests.samples)[:, None],
        position=np.arange(len(rests)), sample_rate=None,
        rests=RawRests(truth.clean, None, world.rate, rests.start, rests.stop),
    )  # fmt: skip
    covariance = known_noise(rows, float(noise[3])).known.covariance
    return np.sqrt(np.diagonal(covariance)).reshape(-1, 5)[:, [0, 1, 3, 4]]


def tried(world: World, seed: int) -> Tried:
    """One log."""
    truth = simulated(world, np.random.default_rng(seed))
    began = perf_counter()
    found = calibrate(truth.session)
    taken = perf_counter() - began
    sigma, covariance, _ = of_gyros(found)
    sensors = found.sensors[3:]
    rows = []
    for i, s in enumerate(sensors):
        assert s.scale.value is not None
        assert s.bias.value is not None
        assert s.axis is not None
        off = s.axis_tangents.T @ (s.axis - truth.axes[i])
        rows.append([s.scale.value - truth.scale[i], s.bias.value - truth.bias[i], *off])
    error = np.array(rows)
    reach = np.array([[s.scale.factor(), s.bias.factor(), s.factor("axis"), s.factor("axis")] for s in sensors])
    squared = float(error.ravel() @ np.linalg.solve(covariance, error.ravel()))
    times = len(truth.clean) / world.rate / taken
    return Tried(error, sigma, reach, bound(truth), squared, times)


def line(world: World, some: Iterable[Tried]) -> str:
    """A row of the table."""
    many = list(some)
    error, sigma, best = (np.stack([getattr(t, name) for t in many]) for name in ("error", "sigma", "bound"))
    ratio = (error / best) ** 2
    inside = np.abs(error) <= np.stack([t.reach for t in many]) * sigma
    each = ratio.mean(axis=(0, 1))
    doubt = ratio.mean(axis=(1, 2)).std(ddof=1) / len(many) ** 0.5
    held = inside.mean(axis=(1, 2))
    block = f"{world.gyros}{'' if world.labelled else ', rests found'}"
    cells = [
        block, f"{len(many)}", f"{ratio.mean():.3f} ± {doubt:.3f}",
        ", ".join(f"{r:.2f}" for r in (each[0], each[1], each[2:].mean())),
        f"{100 * held.mean():.1f} ± {100 * held.std(ddof=1) / len(many) ** 0.5:.1f}",
        f"{np.mean([t.squared for t in many]) / (4 * world.gyros):.3f}",
        f"{np.median([t.times for t in many]):.0f}",
    ]  # fmt: skip
    return "| " + " | ".join(cells) + " |"


HEAD = """| gyros | logs | variance over the bound | scale, bias, axis | k = 2 holds, % | e²/dof | × real time |
| --- | --- | --- | --- | --- | --- | --- |"""


def study(logs: int, workers: int) -> str:
    """The table over blocks of 3 to 8 gyros."""
    lines = [HEAD]
    with ProcessPoolExecutor(workers) as pool:
        for number, world in enumerate([*(World(gyros=m) for m in range(3, 9)), World(gyros=4, labelled=False)]):
            seeds = range(1000 * number, 1000 * number + logs)
            lines.append(line(world, pool.map(tried, [world] * logs, seeds, chunksize=2)))
    return "\n".join(lines)
