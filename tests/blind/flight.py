"""Flights with six degrees of freedom, that share no code with the estimator.

A path is flown: speed V along the body's x axis, attitude R by smooth random manoeuvres and coordinated turns, so that
the specific force is Rᵀ(d(R·V)/dt − g) and the rate follows from R. Every sensor sits at its own place, answers late by
its own delay, and shifts its zero with the vibration. m/s², rad/s, m, s throughout.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
G = 9.81
RATE = 50
"""Hz of the samples."""
FINE = 4
"""Steps of the path in a sample: a delay is a whole number of them, a quarter of a sample."""
SMOOTH = 1.2
"""s; a pilot's hand."""
REST = 50.0
"""s at rest before and after the flight, where there is rest."""
ANGULAR = 0.01
"""rad/s of angular vibration for 1 m/s² of the linear one."""


@dataclass(frozen=True, eq=False)
class Block:
    """m accelerometers as they are, u = K·(e·f + b)."""

    axes: Array
    bias: Array
    scale: Array
    position: Array
    delay: Array
    """(m,) steps of the path."""
    rectification: Array
    """(m,) 1/(m/s²)."""

    def changed(self, sensor: int, kind: str, size: float) -> "Block":
        """One sensor moved: bias, m/s²; scale, relative; axis, rad."""
        one = np.eye(len(self.bias))[sensor]
        if kind == "bias":
            return replace(self, bias=self.bias + size * one)
        if kind == "scale":
            return replace(self, scale=self.scale * (1 + size * one))
        across = np.cross(self.axes[sensor], [0.48, 0.6, 0.64])
        moved = self.axes + size * one[:, None] * across / np.linalg.norm(across)
        return replace(self, axes=moved / np.linalg.norm(moved, axis=1, keepdims=True))


@dataclass(frozen=True)
class Setting:
    """Circumstances of a recording."""

    seconds: float = 240.0
    arm: float = 0.05
    """Half of the box in which sensors sit, m."""
    delay: float = 1.0
    """Largest, samples."""
    vibration: float = 1.0
    rest: bool = False
    stated: bool = False
    gyros: bool = False
    noise: float = 1e-3


def draw_block(rng: np.random.Generator, setting: Setting, m: int = 6) -> Block:
    """Sensors on a cone, made a little wrong."""
    turn = 2 * np.pi * np.arange(m) / m
    axes = np.column_stack([np.cos(turn), np.sin(turn), np.full(m, np.sqrt(0.5))])
    axes += 1e-3 * rng.standard_normal((m, 3))
    return Block(
        axes=axes / np.linalg.norm(axes, axis=1, keepdims=True),
        bias=0.01 * rng.standard_normal(m),
        scale=1 + 1e-3 * rng.standard_normal(m),
        position=rng.uniform(-setting.arm, setting.arm, (m, 3)),
        delay=rng.integers(0, round(FINE * setting.delay) + 1, m),
        rectification=3e-5 * rng.standard_normal(m),
    )


def path(setting: Setting, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Specific force (N, 3), rate (N, 3) in the body, and whether airborne, 0 to 1 (N,)."""
    step = 1 / (RATE * FINE)
    count = round(setting.seconds / step)
    airborne = np.ones(count)
    if setting.rest:
        airborne[: round(REST / step)] = airborne[-round(REST / step) :] = 0.0
    legs = [np.repeat(rng.uniform(-1, 1, (1, 3)), round(rng.uniform(6, 16) / step), axis=0) for _ in range(60)]
    roll, pitch, slip = (np.concatenate(legs)[:count] * [1.0, 0.3, 0.05] * airborne[:, None]).T
    width = SMOOTH / step
    roll, pitch, slip = (gaussian_filter1d(x, width) for x in (roll, pitch, slip))
    speed = gaussian_filter1d(airborne * rng.uniform(30, 90), 4 * width)
    turn = G * np.tan(roll) / np.maximum(speed, 20.0) + slip
    moving = gaussian_filter1d(airborne, width)
    yaw = np.cumsum(turn * (moving > 0.01)) * step
    attitude = Rotation.from_euler("ZYX", np.column_stack([yaw, pitch, roll]))
    velocity = attitude.apply(np.column_stack([speed, np.zeros((count, 2))]))
    force = attitude.inv().apply(np.gradient(velocity, step, axis=0) - [0, 0, G])
    between = (attitude[:-1].inv() * attitude[1:]).as_rotvec() / step
    rate = np.vstack([between[:1], 0.5 * (between[1:] + between[:-1]), between[-1:]])
    return force, rate, moving


def vibration(setting: Setting, moving: Array, rng: np.random.Generator) -> Array:
    """(N, 3) m/s²: an engine whose power changes, two tones and a broad band."""
    t = np.arange(len(moving)) / (RATE * FINE)
    power = setting.vibration * moving * (1 + 0.8 * np.sin(2 * np.pi * t / rng.uniform(20, 60) + rng.uniform(0, 6)))
    tones = sum(np.sin(2 * np.pi * f * t[:, None] + rng.uniform(0, 6, 3)) for f in (17.3, 38.9))
    return power[:, None] * (0.6 * tones + 0.5 * rng.standard_normal((len(t), 3)))


def fly(block: Block, setting: Setting, rng: np.random.Generator, way: int | None = None) -> dict[str, Any]:
    """A recording as a session file; the same ``way`` is the same path."""
    force, rate, moving = path(setting, rng if way is None else np.random.default_rng(way))
    shaken = vibration(setting, moving, rng)
    force, rate = force + shaken, rate + ANGULAR * np.roll(shaken, 1, axis=1)
    spin = np.gradient(rate, 1 / (RATE * FINE), axis=0)
    strength = gaussian_filter1d((shaken**2).sum(axis=1), RATE * FINE) / 3
    columns = {}
    for i, e in enumerate(block.axes):
        r = block.position[i]
        felt = force + np.cross(rate, np.cross(rate, r)) + np.cross(spin, r)
        samples = np.maximum(np.arange(0, len(felt), FINE) - int(block.delay[i]), 0)
        late = (felt @ e + block.rectification[i] * strength)[samples]
        columns[f"A{i + 1}"] = block.scale[i] * (late + block.bias[i] + setting.noise * rng.standard_normal(len(late)))
    sensors = [
        described(f"A{i + 1}", e, block.position[i] if setting.stated else None) for i, e in enumerate(nominal(block))
    ]
    if setting.gyros:
        for k, name in enumerate("XYZ"):
            own = 1.01 * rate[::FINE, k] + 0.005 * rng.standard_normal() + 1e-3 * rng.standard_normal(len(rate[::FINE]))
            columns[name] = own
            sensors.append(described(name, np.eye(3)[k], None) | {"kind": "gyroscope", "reading_unit": "rad/s"})
    return document(sensors, columns) | {"programme": "in-service", "sample_rate_hz": RATE}


def tumble(block: Block, rng: np.random.Generator, noise: float = 1e-4) -> dict[str, Any]:
    """The calibration: forty still orientations, read to ``noise``."""
    up = rng.standard_normal((40, 3))
    up *= G / np.linalg.norm(up, axis=1, keepdims=True)
    read = block.scale * (up @ block.axes.T + block.bias + noise * rng.standard_normal((40, len(block.axes))))
    columns = {f"A{i + 1}": column for i, column in enumerate(read.T)}
    errors = {f"{name}_se": np.full(40, noise) for name in columns}
    sensors = [described(name, e, None) for name, e in zip(columns, nominal(block), strict=True)]
    return document(sensors, columns | errors) | {"programme": "arbitrary-orientations"}


def nominal(block: Block) -> Array:
    """(m, 3) axes as drawn."""
    turn = 2 * np.pi * np.arange(len(block.axes)) / len(block.axes)
    return np.column_stack([np.cos(turn), np.sin(turn), np.full(len(turn), np.sqrt(0.5))]) / np.sqrt(1.5)


def described(name: str, axis: Array, position: Array | None) -> dict[str, Any]:
    """A sensor of a session file."""
    own = {"name": name, "nominal_axis": axis.tolist(), "nominal_scale": 1.0, "reading_unit": "m/s²"}
    return own if position is None else own | {"position_m": position.tolist()}


def document(sensors: list[dict[str, Any]], columns: dict[str, Array]) -> dict[str, Any]:
    """The rest of a session file."""
    return {
        "format": "imu-session/1",
        "unit": "R-1",
        "block": "accelerometer",
        "site": {"gravity_m_s2": G},
        "sensors": sensors,
        "table": {name: column.tolist() for name, column in columns.items()},
    }
