"""``python -m benchmarks.study.degrees_of_freedom --sessions 300 --seed 1``: what few readings claim, and if it holds.

Blocks of known truth are set down in random orientations, straight from u = K·(a + b + c·a²); the noise is stated or
not. Printed: how often the 95 % intervals of scale, bias and axis hold the truth, how often a quadratic term is
estimated that is not there, and how often the errors of the means of raw logs hold, of white noise and of a zero that
wanders, each in so many sessions or logs. The parameters of one session go together: its share counts as one figure.
"""

import argparse
import os
from collections.abc import Iterator, Sequence

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from benchmarks.details import BEGIN, END
from benchmarks.study.rates import Rate
from benchmarks.study.report import table
from estimator import Calibration, CalibrationSession, Sensor, Site, calibrate
from estimator.session import ACCELEROMETER, ARBITRARY_ORIENTATIONS, Array
from estimator.static import Intervals, mean_errors

G = 9.81
NOISE = 1e-3
"""m/s²: 100 µg, a good sensor's."""
NORMAL = 1.959964
"""Factor of 95 % for known noise."""
RATE = 100.0
"""Hz, of raw logs."""
CASES = {3: (9, 10, 11, 12, 14, 17, 19), 4: (9, 10, 11), 6: (9, 10, 12)}
"""Orientations by number of sensors: 0 to 10 degrees of freedom of a triad; nine at least, or not all is observable."""


@dataclass(frozen=True, eq=False)
class Block:
    """The true parameters of m sensors."""

    axes: Array
    scale: Array
    bias: Array


def draw(m: int, rng: np.random.Generator) -> tuple[Array, Block]:
    """Nominal axes and a block about them that shows no net turn against them."""
    turn, half = 2 * np.pi * np.arange(m) / m, np.radians(54.7)
    nominal = np.column_stack([np.sin(half) * np.cos(turn), np.sin(half) * np.sin(turn), np.full(m, np.cos(half))])
    axes = nominal + 0.01 * rng.standard_normal((m, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    U, _, Vt = np.linalg.svd(nominal.T @ axes)
    axes = axes @ (U @ np.diag([1, 1, np.linalg.det(U @ Vt)]) @ Vt).T
    return nominal, Block(axes, 0.12 * (1 + 0.02 * rng.standard_normal(m)), 0.05 * rng.standard_normal(m))


def measured(m: int, count: int, stated: bool, rng: np.random.Generator) -> tuple[CalibrationSession, Block]:
    """One session of ``count`` random orientations."""
    nominal, block = draw(m, rng)
    up = rng.standard_normal((count, 3))
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    readings = block.scale * (G * up @ block.axes.T + block.bias + NOISE * rng.standard_normal((count, m)))
    session = CalibrationSession(
        unit="few",
        block=ACCELEROMETER,
        programme=ARBITRARY_ORIENTATIONS,
        sensors=tuple(Sensor(f"A{i + 1}", ACCELEROMETER, nominal[i], 0.12, "V") for i in range(m)),
        readings=readings,
        standard_errors=np.broadcast_to(block.scale * NOISE if stated else np.nan, (count, m)),
        site=Site(gravity=G),
    )
    return session, block


def held(result: Calibration, block: Block) -> list[bool]:
    """Whether the interval of each scale, bias and turn with an uncertainty holds the truth."""
    found = []
    for i, sensor in enumerate(result.sensors):
        for estimate, true in ((sensor.scale, block.scale[i]), (sensor.bias, block.bias[i])):
            if estimate.value is not None and estimate.sigma is not None:
                found.append(abs(estimate.value - true) < estimate.factor(NORMAL) * estimate.sigma)
        if sensor.axis is not None and sensor.axis_sigma is not None:
            turn = sensor.axis_tangents.T @ (block.axes[i] - sensor.axis)
            found += list(np.abs(turn) < sensor.factor("axis", NORMAL) * np.sqrt(np.diag(sensor.axis_covariance)))
    return found


@dataclass(frozen=True)
class Counted:
    """Claims of the sessions of one kind."""

    sensors: int
    orientations: int
    stated: bool
    shares: tuple[float, ...]
    """Share of the intervals that held, for every session with uncertainties."""
    silent: int
    """Sessions without uncertainty."""
    quadratic: int
    """Sessions with a quadratic term that is not there."""

    @property
    def freedom(self) -> int:
        """Degrees of freedom."""
        return self.orientations * (self.sensors - 2) - (4 * self.sensors - 3)

    def __str__(self) -> str:
        coverage = _share(self.shares) if self.shares else "no uncertainty claimed"
        noise, sessions = "stated" if self.stated else "not stated", len(self.shares) + self.silent
        first = f"| {self.sensors} | {self.orientations} | {self.freedom} | {noise} | {coverage} | {self.silent} |"
        return f"{first} {Rate(self.quadratic, sessions)} |"


def counted(m: int, count: int, stated: bool, sessions: int, seed: int) -> Counted:
    """Counts over so many sessions of one kind."""
    rng = np.random.default_rng([seed, m, count, stated])
    shares: list[float] = []
    quadratic = silent = 0
    for _ in range(sessions):
        session, block = measured(m, count, stated, rng)
        result = calibrate(session)
        quadratic += result.sensors[0].observable["quadratic"]
        inside = held(result, block)
        silent += not inside
        shares += [float(np.mean(inside))] if inside else []
    return Counted(m, count, stated, tuple(shares), silent, quadratic)


def _share(shares: Sequence[float]) -> str:
    """The mean share with its interval: Wilson's of as many independent intervals as would scatter so little."""
    p, scatter = float(np.mean(shares)), float(np.var(shares)) / len(shares)
    count = round(p * (1 - p) / scatter) if scatter > 0 else len(shares)
    low, high = Rate(round(p * count), count).interval()
    return f"{100 * p:.1f} % ({100 * low:.1f}–{100 * high:.1f}) in {len(shares)}"


def raw_row(seconds: float, time: float, size: float, logs: int, seed: int) -> str:
    """A row on 20 rests of three sensors: how often the error of a mean holds, and its ratio to the true one."""
    n, decay, start = int(seconds * RATE), np.exp(-1 / (time * RATE)), np.arange(20) * int((seconds + 10) * RATE)
    shares, ratios = [], []
    for k in range(logs):
        rng = np.random.default_rng([seed, n, int(100 * size), k])
        drawn = rng.standard_normal((start[-1] + n + 1000, 3))
        wander = lfilter([np.sqrt(1 - decay**2)], [1, -decay], drawn, axis=0)[1000:]
        log, places = rng.standard_normal(wander.shape) + size * wander, Intervals(start, start + n)
        sigma = mean_errors(log, places).alone
        shares.append(float(np.mean(np.abs(places.means(log)) < NORMAL * sigma)))
        ratios.append(float(sigma.mean()))
    x = time / seconds
    true = np.sqrt(size**2 * 2 * x * (1 + x * np.expm1(-1 / x)) + 1 / n)
    noise = "white" if size == 0 else f"white, and a zero that wanders {size:g} times as much within {time:g} s"
    return f"| {seconds:g} s | {noise} | {_share(shares)} | {np.mean(ratios) / true:.2f} | {_old(n, size, true):.2f} |"


def _old(n: int, size: float, true: float) -> float:
    """sd/√n over the true error of a mean."""
    return float(np.sqrt((1 + size**2) / n) / true)


def orientations(sessions: int, seed: int) -> Iterator[Counted]:
    """Every kind of session in turn."""
    for m, counts in CASES.items():
        for count in counts:
            yield counted(m, count, True, sessions, seed)
            yield counted(m, count, False, sessions, seed)


def targets(found: Sequence[Counted]) -> str:
    """Targets of sessions that do not state their noise."""
    few = [share for c in found if not c.stated and 1 <= c.freedom <= 10 for share in c.shares]
    none = [c for c in found if not c.stated and c.freedom == 0]
    claims = Rate(sum(len(c.shares) for c in none), sum(len(c.shares) + c.silent for c in none))
    rows = [
        ("noise not stated, 1 to 10 degrees of freedom: 95 % intervals hold", "93–97 %", _share(few)),
        ("noise not stated, no degree of freedom: an uncertainty is claimed", "never", claims),
    ]
    return table(("figure", "target", "measured"), rows)


def lines(found: Sequence[Counted], sessions: int, seed: int) -> Iterator[str]:
    """All tables in Markdown, line by line."""
    yield targets(found)
    yield ""
    yield BEGIN
    yield ""
    yield (
        "| sensors | orientations | degrees of freedom | noise | 95 % intervals hold | sessions without uncertainty "
        "| a quadratic term that is not there |"
    )
    yield "| --- | --- | --- | --- | --- | --- | --- |"
    yield from map(str, found)
    yield ""
    yield "| rest | noise of the samples | 95 % intervals of a mean hold | its error over the truth | sd/√n over it |"
    yield "| --- | --- | --- | --- | --- |"
    for seconds in (2.0, 5.0, 10.0):
        for time, size in ((2.0, 0.0), (0.5, 0.3), (2.0, 0.1), (2.0, 0.3)):
            yield raw_row(seconds, time, size, max(sessions // 3, 1), seed)
    yield ""
    yield END


def tables(sessions: int, seed: int) -> str:
    """All tables in Markdown."""
    return "\n".join(lines(list(orientations(sessions, seed)), sessions, seed))


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study.degrees_of_freedom", description=__doc__)
    parser.add_argument("--sessions", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    print(tables(options.sessions, options.seed))


if __name__ == "__main__":
    main()
