"""Stated errors beside true ones, of raw logs that a hand holds: ``python -m benchmarks.rests [logs]``.

The twins share nothing with `estimator.rest_noise`: the block's orientation is integrated sample by sample, from a
random walk that is turned back at its bounds, tremor of 8 to 12 Hz and a settling after each turn; sensors have white
and flicker noise (`tests.estimator.allan.noises`), biases, scale errors and axes of their own. Then the five MPU-9150.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, sosfilt
from scipy.spatial.transform import Rotation

from benchmarks.recordings.sets import folder, logs
from benchmarks.recordings.tables import table
from estimator.applied_vector import EARTH_RATE
from estimator.arrays import nearest_turn, unit
from estimator.calibration import calibrate
from estimator.calibration.calibrate import averaged
from estimator.calibration.free import residual_per_freedom
from estimator.results import Calibration
from estimator.session import ACCELEROMETER, ARBITRARY_ORIENTATIONS, GYROSCOPE, Array, CalibrationSession, Sensor, Site
from estimator.static import average
from tests.estimator.allan.noises import flicker

RATE, G = 100.0, 9.81
REST, POSES = 6.0, 24
"""s of a rest; rests a log."""
WHITE = {ACCELEROMETER: 0.02, GYROSCOPE: 1e-3}
"""m/s² and rad/s of a sample: an inexpensive MEMS sensor's."""
FLICKER = 0.02
"""Size of the flicker, in white noise of a sample."""
PARAMETERS = ("scale", "bias", "axis", "gyro bias")
"""Parameters whose errors the table shows."""
NORMAL = 1.959964
"""Standard deviations of a normal interval of 95 %."""
LOGS = 24


@dataclass(frozen=True)
class World:
    """Logs of one kind."""

    accelerometers: int
    tilt: float
    """°; bound of the random walk; tremor and settling in proportion."""
    gyros: int = 3

    @property
    def name(self) -> str:
        """Name in the table."""
        return f"{self.accelerometers} accelerometers, {self.tilt:g}°"


WORLDS = tuple(World(m, tilt) for m in (3, 6, 15) for tilt in (0.0, 0.05, 0.2))


@dataclass(frozen=True, eq=False)
class Truth:
    """The truth of one log. m accelerometers."""

    scale: Array
    bias: Array
    axes: Array
    noise: Array
    """(n, m) error of the mean of each rest by the sensors' own noise, m/s² at the input."""
    gyro_bias: Array
    """rad/s."""


def turned(walk: Array, bound: float) -> Array:
    """A walk (n, 3) reflected at ± bound."""
    return bound * (2 / np.pi) * np.arcsin(np.sin(walk * np.pi / (2 * bound))) if bound else np.zeros_like(walk)


def orientation(n: int, tilt: float, rng: np.random.Generator) -> Array:
    """(n, 3) rotation vector of the block within one rest, rad."""
    bound = np.radians(tilt)
    speed = 10 ** rng.uniform(-1, 0)
    walk = turned(np.cumsum(bound * speed / np.sqrt(RATE) * rng.standard_normal((n, 3)), axis=0), bound)
    band = butter(2, [8.0, 12.0], "bandpass", fs=RATE, output="sos")
    shake = sosfilt(band, rng.standard_normal((n + 100, 3)), axis=0)[100:]
    t = np.arange(n)[:, None] / RATE
    settling = rng.standard_normal(3) * np.exp(-t / rng.uniform(0.3, 2.0))
    return walk + bound * (0.05 * shake / shake.std() + 0.3 * settling)


def noise(n: int, m: int, size: float, rng: np.random.Generator) -> Array:
    """(n, m) white and flicker, about the mean of all: what lasts is bias."""
    slow = np.column_stack([flicker(n, rng) for _ in range(m)])
    sum_of_both = size * (rng.standard_normal((n, m)) + FLICKER * slow)
    return sum_of_both - sum_of_both.mean(axis=0)


def axes_of(m: int, rng: np.random.Generator) -> Array:
    """(m, 3) nominal axes: triads, each turned anew but the first."""
    triads = [np.eye(3), *(Rotation.random(random_state=rng).as_matrix() for _ in range((m - 1) // 3))]
    return np.vstack(triads)[:m]


def twin(world: World, seed: int) -> tuple[CalibrationSession, Truth]:
    """A raw log with labelled rests, and its truth."""
    rng = np.random.default_rng([seed, world.accelerometers, round(1000 * world.tilt)])
    m, k = world.accelerometers, world.gyros
    nominal = axes_of(m, rng)
    axes = unit(nominal + np.radians(0.5) * rng.standard_normal((m, 3)))
    scale, bias = 1 + 0.01 * rng.standard_normal(m), 0.1 * rng.standard_normal(m)
    n, up = round(REST * RATE), unit(rng.standard_normal((POSES, 3)))
    own, spin = noise(POSES * n, m, WHITE[ACCELEROMETER], rng), noise(POSES * n, k, WHITE[GYROSCOPE], rng)
    rests, gyro_bias = [], 0.01 * rng.standard_normal(k)
    for direction in up:
        earth = EARTH_RATE * unit(rng.standard_normal((1, 3)))[:, :k]
        angle = orientation(n + 1, world.tilt, rng)
        force = G * Rotation.from_rotvec(-angle[1:]).apply(direction)
        rests.append(np.hstack([force @ axes.T + bias, np.diff(angle, axis=0)[:, :k] * RATE + gyro_bias + earth]))
    readings = np.vstack(rests) + np.hstack([own, spin])
    readings[:, :m] *= scale
    kinds = [ACCELEROMETER] * m + [GYROSCOPE] * k
    lines = np.vstack([nominal, np.eye(3)[:k]])
    sensors = tuple(Sensor(f"{kind[0].upper()}{i}", kind, lines[i], 1.0, "SI") for i, kind in enumerate(kinds))
    session = CalibrationSession(
        unit="twin",
        block=ACCELEROMETER,
        programme=ARBITRARY_ORIENTATIONS,
        sensors=sensors,
        readings=readings,
        standard_errors=np.full(readings.shape, np.nan),
        site=Site(gravity=G),
        position=np.repeat(np.arange(POSES), n),
        sample_rate=RATE,
    )
    trim = int(0.05 * n)
    means = own.reshape(POSES, n, m)[:, trim : n - trim].mean(axis=1)
    return session, Truth(scale, bias, axes @ nearest_turn(axes, nominal).T, means, gyro_bias)


def errors(result: Calibration, truth: Truth) -> Iterator[tuple[str, float, float, float]]:
    """Name, error, stated sigma and factor of 95 % of every parameter."""
    for i, (scale, bias, axis) in enumerate(zip(truth.scale, truth.bias, truth.axes, strict=True)):
        one = result.sensors[i]
        for name, true in (("scale", scale), ("bias", bias)):
            found = getattr(one, name)
            yield name, found.value - true, found.sigma, found.factor(NORMAL)
        assert one.axis is not None
        sigma = np.sqrt(np.diag(one.axis_covariance))
        for off, u in zip(one.axis_tangents.T @ (one.axis - axis), sigma, strict=True):
            yield "axis", float(off), float(u), one.factor("axis", NORMAL)
    for gyro, true in zip(result.sensors[len(truth.scale) :], truth.gyro_bias, strict=True):
        assert gyro.bias.value is not None
        assert gyro.bias.sigma is not None
        yield "gyro bias", gyro.bias.value - true, gyro.bias.sigma, gyro.bias.factor(NORMAL)


def share(held: Array) -> str:
    """Share of intervals (logs, parameters) that hold the truth, in per cent, with the 95 % interval that the logs
    show.
    """
    each = 100 * held.mean(axis=1)
    return f"{each.mean():.1f} ± {NORMAL * each.std(ddof=1) / np.sqrt(len(each)):.1f}"


def ratio(stated: Array, true: Array) -> str:
    """Ratio of the root mean squares of stated and true errors, of one shape and unit."""
    return f"{np.sqrt(np.mean(stated**2) / np.mean(true**2)):.2f}"


def line(world: World, count: int) -> list[str]:
    """A row of the table."""
    m, found, before, after, true = world.accelerometers, [], [], [], []
    for seed in range(count):
        log, truth = twin(world, seed)
        rows, together = averaged(log), average(log, residual_per_freedom)
        before.append(together.standard_errors[:, :m] / truth.scale)
        after.append(rows.standard_errors[:, :m] / truth.scale)
        true.append(truth.noise)
        found.append(list(errors(calibrate(rows, quadratic=False), truth)))
    names = np.array([name for name, *_ in found[0]])
    off, sigma, factor = np.moveaxis(np.array([[one[1:] for one in log] for log in found]), -1, 0)
    parts = [ratio(sigma[:, names == name], off[:, names == name]) for name in PARAMETERS]
    of_means = [ratio(np.array(stated), np.array(true)) for stated in (before, after)]
    accelerometers = names != PARAMETERS[-1]
    return [world.name, *of_means, *parts, share((np.abs(off) < factor * sigma)[:, accelerometers])]


PAGE = """# Rests in a hand: stated errors over true ones

Printed by `python -m benchmarks.rests`: raw logs of 24 rests of 6 s, 100 Hz, of a block that a hand tilts; rms of the
stated standard errors over that of the true errors, of the means of the rests and of the calibration's parameters.
*Tilt as noise*: every sensor's mean takes what the block does for noise of its own. The intervals are those of the
accelerometers' scales, biases and axes; ± is their 95 % interval by the scatter of the logs.
"""
RECORDED = """Five MPU-9150 turned by hand: median standard error of an accelerometer's mean, χ² per degree of freedom
of the calibration, and the median standard error of a rest's mean tilt."""
HEAD = ("block, tilt", "mean, tilt as noise", "mean", *PARAMETERS, "95 % intervals that hold the truth, %")


def recorded() -> str:
    """Residuals against stated errors of the five MPU-9150: tilt counted as noise, and as it is."""
    body, together = [], np.zeros((2, 2))
    for log in logs("mpu9150-five")[:5]:
        cells = []
        for k, rows in enumerate((average(log.session, residual_per_freedom), averaged(log.session))):
            fit = calibrate(rows, quadratic=False).fit
            together[k] += fit.chi2, fit.dof
            cells += [f"{1000 * np.median(rows.standard_errors[:, :3]):.2f}", f"{fit.chi2 / fit.dof:.3f}"]
        tilt = np.zeros(1) if rows.tilt_error is None else rows.tilt_error
        body.append([log.name, *cells, f"{np.degrees(np.median(tilt)):.2f}"])
    before, after = together[:, 0] / together[:, 1]
    body.append(["all five", "", f"{before:.3f}", "", f"{after:.3f}", ""])
    head = ["recording", "error, tilt as noise", "χ² / freedom", "error, mm/s²", "χ² / freedom", "tilt, °"]
    return table(head, body)


def main(count: int) -> None:
    """Prints both tables."""
    print(PAGE)
    print(table(HEAD, []))
    for world in WORLDS:
        print("| " + " | ".join(line(world, count)) + " |", flush=True)
    if folder().exists():
        print(f"\n{RECORDED}\n\n{recorded()}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else LOGS)
