"""Recordings of redundant blocks in service, sound and with faults that begin within them.

Body, motion, sensors and faults are written here from first principles. A block of m accelerometers on a cone, on the
axes of a dodecahedron or at random rests, turns, climbs and banks; engine power, and with it vibration, changes; the
body bends with load; sensors sit apart, answer late, shift with vibration, drift while warming, are read in counts,
are cut off at the end of their range and lose samples. m/s², rad/s, s, m.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
G = 9.81
APART = np.radians(15.0)
"""Least angle between any two sensors as they lie in parity: nothing distinguishes nearer ones."""
MEDIAN = 0.455
"""Median of the square of a standard normal number."""
LEAST_SEEN = 0.15
"""Share of a sensor that shows in parity."""


@dataclass(frozen=True, eq=False)
class Unit:
    """m accelerometers as they are, u = K·(e·f + b)."""

    axes: Array
    scale: Array
    bias: Array
    position: Array
    delay: Array
    """(m,) samples."""
    rectification: Array
    """(m,) s²/m."""
    bending: Array
    """(m, 3) rad per g and its turn: how a sensor leans with the load along each body axis."""
    warming: Array
    """(m,) m/s² of drift while warming."""
    noise: Array
    """(m,) m/s² a sample."""
    count: float
    """Reading units."""
    limit: float
    """m/s² at the end of the range."""

    @property
    def parity(self) -> Array:
        """(m, m − 3) basis of what no vector explains."""
        return np.linalg.svd(self.axes)[0][:, 3:]


@dataclass(frozen=True)
class Fault:
    """One sensor from one moment on."""

    sensor: int
    kind: str
    since: float
    """s"""
    size: float = 0.0
    other: int | None = None
    """The one that it is exchanged with."""
    spells: tuple[tuple[float, float], ...] = ()
    """s, from and to; of one that comes and goes."""


@dataclass(frozen=True, eq=False)
class Flight:
    """A recording before it is read."""

    unit: Unit
    rate: float
    inputs: Array
    """(R, m) inputs of every sensor with its own errors, m/s², unlimited and without its own white noise."""
    noise: Array
    """(R, m) m/s²."""
    lost: NDArray[np.bool_]
    """(R,) samples that are missing."""
    fault: tuple[Fault, ...] = field(default=())

    def readings(self, faults: tuple[Fault, ...] = (), rng: np.random.Generator | None = None) -> Array:
        """(R', m) reading units, with faults put in."""
        felt = self.inputs + self.noise + self.unit.bias
        for fault in faults:
            felt = self._failed(felt, fault, rng or np.random.default_rng(0))
        limit = self.unit.limit
        u = self.unit.scale * np.clip(felt, -limit, limit)
        u = np.round(u / self.unit.count) * self.unit.count
        for fault in faults:
            self._read_wrongly(u, fault)
        return np.asarray(u[~self.lost])

    def _failed(self, felt: Array, fault: Fault, rng: np.random.Generator) -> Array:
        felt, i = felt.copy(), fault.sensor
        t = np.arange(len(felt)) / self.rate
        on = t >= fault.since
        if fault.kind == "step":
            felt[on, i] += fault.size
        elif fault.kind == "ramp":
            felt[:, i] += fault.size * np.maximum(t - fault.since, 0.0)
        elif fault.kind == "gain":
            felt[on, i] *= 1.0 + fault.size
        elif fault.kind == "noise":
            felt[on, i] += fault.size * rng.standard_normal(int(on.sum()))
        elif fault.kind == "delay":
            late = np.interp(t - fault.size, t, felt[:, i])
            felt[on, i] = late[on]
        elif fault.kind == "intermittent":
            for begin, end in fault.spells:
                felt[(t >= begin) & (t < end), i] += fault.size
        return felt

    def _read_wrongly(self, u: Array, fault: Fault) -> None:
        first, i = round(fault.since * self.rate), fault.sensor
        if fault.kind == "stuck":
            u[first:, i] = u[max(first - 1, 0), i]
        elif fault.kind == "zero":
            u[first:, i] = 0.0
        elif fault.kind == "full-scale":
            u[first:, i] = np.sign(fault.size) * np.round(self.unit.scale[i] * self.unit.limit / self.unit.count)
            u[first:, i] *= self.unit.count
        elif fault.kind == "exchanged":
            pair = [i, fault.other]
            u[first:, pair] = u[first:, pair[::-1]]

    def since_in_rows(self, since: float) -> float:
        """s of the rows that are left before a moment."""
        return float((~self.lost[: round(since * self.rate)]).sum() / self.rate)

    def standard_error(self, sensor: int) -> float:
        """m/s² of a one-second mean of that sensor as it lies in parity, from one second to the next, typically."""
        V, n = self.unit.parity, int(self.rate)
        whole = len(self.inputs) // n * n
        p = ((self.inputs + self.noise)[:whole] @ V).reshape(-1, n, V.shape[1]).mean(axis=1)
        y = p @ V[sensor] / (V[sensor] @ V[sensor])
        return float(np.sqrt(np.nanmedian(np.diff(y, 2) ** 2) / MEDIAN / 6.0))


def axes_of(m: int, rng: np.random.Generator) -> Array:
    """(m, 3): cone, dodecahedron or random, one like the other told apart in parity."""
    while True:
        kind = rng.choice(["cone", "dodecahedron", "random"])
        if kind == "cone":
            turn = 2 * np.pi * np.arange(m) / m
            z = rng.uniform(0.3, 0.8)
            e = np.column_stack([np.sqrt(1 - z**2) * np.cos(turn), np.sqrt(1 - z**2) * np.sin(turn), np.full(m, z)])
        elif kind == "dodecahedron" and m <= 6:
            s, c = 0.525731, 0.850651
            e = np.array([[s, 0, c], [-s, 0, c], [c, s, 0], [c, -s, 0], [0, c, s], [0, c, -s]])[:m]
        else:
            e = rng.standard_normal((m, 3))
        e = e / np.linalg.norm(e, axis=1, keepdims=True) + 2e-3 * rng.standard_normal((m, 3))
        e /= np.linalg.norm(e, axis=1, keepdims=True)
        if apart(e):
            return np.asarray(e)


def apart(axes: Array) -> bool:
    """Whether every sensor shows, and no two look alike."""
    V = np.linalg.svd(axes)[0][:, 3:]
    seen = (V**2).sum(axis=1)
    if seen.min() < LEAST_SEEN or np.linalg.svd(axes)[1][-1] < 0.5:
        return False
    if len(axes) == 4:
        return True
    alike = np.abs(V @ V.T / np.sqrt(np.outer(seen, seen))) - np.eye(len(axes))
    return bool(alike.max() < np.cos(APART))


def draw_unit(m: int, rng: np.random.Generator) -> Unit:
    """A block of inexpensive to good accelerometers."""
    noise = 10 ** rng.uniform(-3, -1.5) * rng.uniform(0.7, 1.4, m)
    scale = rng.choice([1.0, 100.0, 1671.8]) * (1 + 0.005 * rng.standard_normal(m))
    return Unit(
        axes=axes_of(m, rng),
        scale=scale,
        bias=0.05 * rng.standard_normal(m),
        position=rng.uniform(-0.1, 0.1, (m, 3)) * rng.uniform(0, 1),
        delay=rng.uniform(0, 2, m) * rng.uniform(0, 1),
        rectification=3e-5 * rng.standard_normal(m),
        bending=2e-4 * rng.uniform(0, 1) * rng.standard_normal((m, 3)),
        warming=rng.uniform(0, 0.02) * rng.standard_normal(m) * (rng.uniform() < 0.5),
        noise=noise,
        count=float(scale.mean() * noise.mean() * rng.choice([1e-3, 0.3, 2.0])),
        limit=float(rng.choice([2.0, 4.0, 8.0]) * G),
    )


def motion(seconds: float, rate: float, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Specific force (R, 3), rate (R, 3) and engine power 0 … 1 (R,): rests, turns, climbs, by a pilot's hand."""
    count = int(seconds * rate)
    legs: list[Array] = []
    while sum(map(len, legs)) < count:
        n = int(rng.uniform(5, 25) * rate)
        what = rng.choice(["level", "turn", "climb", "rest"])
        roll, pitch, power = {
            "level": (0.0, 0.02, 0.5), "turn": (rng.uniform(-1, 1), 0.05, 0.7),
            "climb": (0.0, rng.uniform(-0.4, 0.4), 1.0), "rest": (0.0, 0.0, 0.0),
        }[str(what)]  # fmt: skip
        legs.append(np.tile([roll, pitch, power], (n, 1)))
    roll, pitch, thrust = gaussian_filter1d(np.concatenate(legs)[:count], rng.uniform(0.5, 1.5) * rate, axis=0).T
    thrust = gaussian_filter1d(thrust, 2 * rate)
    gust = gaussian_filter1d(rng.standard_normal((count, 3)), 0.3 * rate, axis=0)
    gust *= rng.uniform(0, 0.05) * thrust[:, None] / gust.std()
    roll, pitch = roll + gust[:, 0], pitch + gust[:, 1]
    turn = G * np.tan(roll) / rng.uniform(25, 60) + gust[:, 2]
    attitude = Rotation.from_euler("ZYX", np.column_stack([np.cumsum(turn) / rate, pitch, roll]))
    ahead = gaussian_filter1d(rng.uniform(0.5, 3) * np.gradient(thrust, 1 / rate), rate)
    flown = np.column_stack([ahead, np.zeros(count), np.zeros(count)])
    lift = np.column_stack([G * np.sin(pitch), np.zeros(count), -G * np.cos(pitch) / np.cos(roll)])
    still = attitude.inv().apply(np.tile([0.0, 0.0, -G], (count, 1)))
    f = (still if rng.uniform() < 0.4 else lift) + flown
    omega = np.vstack([np.zeros(3), (attitude[:-1].inv() * attitude[1:]).as_rotvec() * rate])
    return np.asarray(f), np.asarray(omega), np.asarray(thrust)


def draw_flight(m: int, rng: np.random.Generator) -> Flight:
    """A sound recording."""
    unit = draw_unit(m, rng)
    rate, seconds = float(rng.choice([50, 100, 200])), float(rng.uniform(120, 300))
    f, omega, power = motion(seconds, rate, rng)
    t = np.arange(len(f)) / rate
    amplitude = rng.choice([0.02, 0.3, 2.0]) * power * (1 + 0.4 * np.sin(2 * np.pi * t / rng.uniform(15, 60)))
    tones = sum(np.sin(2 * np.pi * rate * part * t[:, None] + rng.uniform(0, 6, 3)) for part in (0.117, 0.231))
    shaken = amplitude[:, None] * (0.6 * tones + 0.4 * rng.standard_normal((len(t), 3))) @ np.diag([0.5, 0.7, 1.0])
    spin = np.gradient(omega, 1 / rate, axis=0)
    strength = gaussian_filter1d((shaken**2).sum(axis=1), rate)
    warm = 1 - np.exp(-t / rng.uniform(60, 400))
    inputs = np.empty((len(t), m))
    for i, e in enumerate(unit.axes):
        r = unit.position[i]
        felt = f + shaken + np.cross(omega, np.cross(omega, r)) + np.cross(spin, r)
        along = felt @ e + (f @ unit.bending[i]) + unit.rectification[i] * strength
        inputs[:, i] = np.interp(t - unit.delay[i] / rate, t, along) + unit.warming[i] * warm
    lost = np.zeros(len(t), dtype=bool)
    for _ in range(int(rng.integers(0, 4))):
        first = int(rng.integers(0, len(t)))
        lost[first : first + int(rng.integers(1, int(0.3 * rate)))] = True
    return Flight(unit, rate, inputs, unit.noise * rng.standard_normal(inputs.shape), lost)


def tumble(unit: Unit, rng: np.random.Generator) -> dict[str, Any]:
    """The calibration: thirty still orientations, in which the body bends under its own weight."""
    up = rng.standard_normal((30, 3))
    up *= G / np.linalg.norm(up, axis=1, keepdims=True)
    error = unit.noise / 30.0
    bent = up @ (unit.axes + unit.bending).T
    u = unit.scale * (bent + unit.bias + error * rng.standard_normal((30, len(unit.axes))))
    columns = {f"A{i + 1}": u[:, i].tolist() for i in range(u.shape[1])}
    errors = {f"A{i + 1}_se": [float(unit.scale[i] * error[i])] * 30 for i in range(u.shape[1])}
    return document(unit, columns | errors) | {"programme": "arbitrary-orientations"}


def recorded(flight: Flight, readings: Array) -> dict[str, Any]:
    """The recording as a session file."""
    columns = {f"A{i + 1}": readings[:, i].tolist() for i in range(readings.shape[1])}
    return document(flight.unit, columns) | {"programme": "in-service", "sample_rate_hz": flight.rate}


def document(unit: Unit, columns: dict[str, Any]) -> dict[str, Any]:
    """The rest of a session file."""
    sensors = [
        {"name": f"A{i + 1}", "nominal_axis": e.tolist(), "nominal_scale": float(unit.scale.mean()),
         "reading_unit": "LSB"} for i, e in enumerate(unit.axes)
    ]  # fmt: skip
    return {
        "format": "imu-session/1", "unit": "S-1", "block": "accelerometer", "site": {"gravity_m_s2": G},
        "sensors": sensors, "table": columns,
    }  # fmt: skip
