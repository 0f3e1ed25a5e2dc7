"""Session files for tests, as dicts. Readings come straight from the equations of the convention page.

Nothing here imports the package's own forward model, so a fault there cannot hide here.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Document = dict[str, Any]

GRAVITY = 9.81532
EARTH_RATE = 7.292115e-5
LATITUDE_DEG = 55.81
ARCSEC = math.pi / 648_000
FLIP = np.array([-1.0, -1.0, 1.0])
CONE_HALF_ANGLE = math.acos(1 / math.sqrt(3))


@dataclass(frozen=True)
class TrueSensor:
    """True parameters of a sensor: u = scale·(a + bias + quadratic·a²), a = axis·n."""

    name: str
    axis: tuple[float, float, float]
    scale: float = 0.12
    bias: float = 0.0
    quadratic: float = 0.0


def cone_axes(m: int, half_angle: float = CONE_HALF_ANGLE) -> Array:
    """(m, 3) unit vectors, dimensionless, evenly spread on a cone about Y; three of them are an orthogonal triad."""
    turn = 2 * np.pi * np.arange(m) / m
    side, along = np.sin(half_angle), np.cos(half_angle)
    return np.column_stack([side * np.cos(turn), np.full(m, along), side * np.sin(turn)])


def true_sensors(
    m: int = 6,
    *,
    prefix: str = "A",
    scale: float = 0.12,
    bias: float = 0.0,
    quadratic: float = 0.0,
    tilt: float = 0.0,
    seed: int = 0,
) -> list[TrueSensor]:
    """m sensors on a cone; ``bias``, ``quadratic`` and ``tilt`` (rad) are one sigma of what they have."""
    rng = np.random.default_rng(seed)
    axes = cone_axes(m) + tilt * rng.standard_normal((m, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    return [
        TrueSensor(
            f"{prefix}{i + 1}",
            tuple(map(float, axes[i])),
            scale,
            float(bias * rng.standard_normal()),
            float(quadratic * rng.standard_normal()),
        )
        for i in range(m)
    ]


def stand_vectors(norm: float, elevation_deg: float, beta_deg: Array, flipped: Array) -> Array:
    """(R, 3) norm·(−cos α sin β, sin α, cos α cos β) in platform axes, turned about Z in the flipped run.

    In the unit of the norm, m/s² or rad/s; ``beta_deg`` (R,) in degrees, ``flipped`` (R,) true or false.
    """
    alpha, beta = math.radians(elevation_deg), np.radians(beta_deg)
    n = norm * np.column_stack(
        [-math.cos(alpha) * np.sin(beta), np.full(len(beta), math.sin(alpha)), math.cos(alpha) * np.cos(beta)]
    )
    return np.where(flipped[:, None], n * FLIP, n)


def response(sensor: TrueSensor, vectors: Array) -> Array:
    """(R,) readings without noise of one sensor, in its reading unit, for applied vectors (R, 3), m/s² or rad/s."""
    a = vectors @ np.asarray(sensor.axis)
    return sensor.scale * (a + sensor.bias + sensor.quadratic * a**2)


def declared(sensors: list[TrueSensor], unit: str, **common: Any) -> list[Document]:
    """The ``sensors`` of a session file: nominal cone axes, the true scale as the nominal one."""
    axes = cone_axes(len(sensors))
    return [
        {
            "name": s.name,
            "nominal_axis": [float(x) for x in axes[i]],
            "nominal_scale": s.scale,
            "reading_unit": unit,
            **common,
        }
        for i, s in enumerate(sensors)
    ]


def stand_rows(positions: int, runs: tuple[str, ...]) -> tuple[list[str], Array, Array]:
    """Run label, β (R,) in °, and whether flipped (R,), of R rows."""
    beta = np.tile(360.0 * np.arange(positions) / positions, len(runs))
    labels = [run for run in runs for _ in range(positions)]
    return labels, beta, np.array([label == "flipped" for label in labels])


def noisy(readings: Array, se: float, seed: int) -> list[float]:
    """Readings (R,) with white noise of one sigma ``se``, both in reading units."""
    rng = np.random.default_rng(seed)
    return [float(u) for u in readings + se * rng.standard_normal(len(readings))]


def accelerometer_block(
    m: int = 6,
    *,
    positions: int = 12,
    alpha_deg: float = 40.0,
    se: float = 3e-6,
    runs: tuple[str, ...] = ("direct", "flipped"),
    sensors: list[TrueSensor] | None = None,
    mounting: Array | None = None,
    seed: int = 1,
    unit: str = "BA-017",
) -> Document:
    """A block of accelerometers on the two-axis stand, readings in V; ``mounting`` (3, 3), dimensionless."""
    true = sensors or true_sensors(m, bias=1e-3, quadratic=1e-6, tilt=1e-4)
    labels, beta, flipped = stand_rows(positions, runs)
    turn = np.eye(3) if mounting is None else mounting
    vectors = stand_vectors(GRAVITY, alpha_deg, beta, flipped) @ turn.T
    table: Document = {
        "run": labels,
        "beta_deg": [float(b) for b in beta],
        "time_s": [60.0 * j for j in range(len(beta))],
        "temperature_c": [21.0] * len(beta),
    }
    for i, sensor in enumerate(true):
        table[sensor.name] = noisy(response(sensor, vectors), se, seed * 1000 + i)
        table[f"{sensor.name}_se"] = [se] * len(beta)
    return {
        "format": "imu-session/1",
        "unit": unit,
        "block": "accelerometer",
        "programme": "two-axis-stand",
        "started_at": "2026-03-01T09:00:00Z",
        "operator": "K. Ito",
        "notes": "made for a test",
        "site": {"latitude_deg": LATITUDE_DEG, "height_m": 160.0, "gravity_m_s2": GRAVITY},
        "stand": {
            "id": "ODG-1",
            "alpha_deg": alpha_deg,
            "sigma_arcsec": {"theta_x": 0.33, "theta_y": 0.33, "alpha": 1.0, "beta": 1.0},
        },
        "mounting": turn.tolist(),
        "sensors": declared(true, "V", bias_repeatability_m_s2=9.8e-5),
        "table": table,
    }


def gyro_block(
    m: int = 6,
    *,
    positions: int = 12,
    chi_deg: float = 40.0,
    count_time_s: float | None = 100.0,
    se: float = 0.3,
    sensors: list[TrueSensor] | None = None,
    seed: int = 2,
) -> Document:
    """A block of pulse gyros on the two-axis stand; ``count_time_s=None`` makes them rate gyros."""
    true = sensors or true_sensors(m, prefix="G", scale=1 / (0.6 * ARCSEC), bias=2e-8, tilt=1e-4)
    labels, beta, flipped = stand_rows(positions, ("direct", "flipped"))
    vectors = stand_vectors(EARTH_RATE, chi_deg, beta, flipped)
    table: Document = {
        "run": labels,
        "beta_deg": [float(b) for b in beta],
        "time_s": [200.0 * j for j in range(len(beta))],
    }
    for i, sensor in enumerate(true):
        pulses = (count_time_s or 1.0) * response(sensor, vectors)
        table[sensor.name] = noisy(pulses, se, seed * 1000 + i)
        table[f"{sensor.name}_se"] = [se] * len(beta)
    document = {
        "format": "imu-session/1",
        "unit": "BG-004",
        "block": "gyroscope",
        "programme": "two-axis-stand",
        "started_at": "2026-03-02T09:00:00+03:00",
        "site": {"latitude_deg": LATITUDE_DEG, "height_m": 160.0},
        "stand": {
            "id": "ODG-1",
            "chi_deg": chi_deg,
            "sigma_count_time_s": 1e-5,
            "sigma_arcsec": {"theta_x": 0.33, "beta": 1.0, "latitude": 1.0, "meridian": 5.0},
        },
        "sensors": declared(true, "pulse" if count_time_s else "V", bias_repeatability_rad_s=6e-8),
        "table": table,
    }
    return document | ({"count_time_s": count_time_s} if count_time_s else {})


def directions_on_sphere(count: int, seed: int = 3) -> Array:
    """(count, 3) unit vectors, dimensionless, drawn evenly over the sphere."""
    v = np.random.default_rng(seed).standard_normal((count, 3))
    unit: Array = v / np.linalg.norm(v, axis=1, keepdims=True)
    return unit


def arbitrary_orientations(
    m: int = 6,
    *,
    orientations: int = 24,
    se: float | None = 3e-6,
    sensors: list[TrueSensor] | None = None,
    direction_sigma_deg: float | None = None,
    seed: int = 3,
    unit: str = "HAND-1",
) -> Document:
    """Still orientations of an accelerometer block, averaged; directions stated when their sigma is."""
    true = sensors or true_sensors(m, bias=1e-3, tilt=1e-4)
    up = directions_on_sphere(orientations, seed)
    table: Document = {"time_s": [60.0 * j for j in range(orientations)]}
    for i, sensor in enumerate(true):
        table[sensor.name] = noisy(response(sensor, GRAVITY * up), se or 3e-6, seed * 1000 + i)
        if se:
            table[f"{sensor.name}_se"] = [se] * orientations
    document: Document = {
        "format": "imu-session/1",
        "unit": unit,
        "block": "accelerometer",
        "programme": "arbitrary-orientations",
        "started_at": "2026-03-03T09:00:00Z",
        "site": {"gravity_m_s2": GRAVITY},
        "sensors": declared(true, "V"),
        "table": table,
    }
    if direction_sigma_deg is not None:
        error = math.radians(direction_sigma_deg) * np.random.default_rng(seed + 1).standard_normal(up.shape)
        stated = (up + error) / np.linalg.norm(up + error, axis=1, keepdims=True)
        table |= {f"direction_{axis}": [float(x) for x in stated[:, k]] for k, axis in enumerate("xyz")}
        document["direction_sigma_deg"] = direction_sigma_deg
    return document


def raw_log(
    m: int = 3,
    *,
    orientations: int = 12,
    still: int = 100,
    moving: int = 40,
    rate_hz: float = 100.0,
    noise: float = 1e-3,
    labelled: bool = True,
    sensors: list[TrueSensor] | None = None,
    seed: int = 4,
) -> Document:
    """A log of samples: still intervals with turns between them; ``position`` is −1 during a turn."""
    true = sensors or true_sensors(m, bias=1e-3, tilt=1e-4)
    up = directions_on_sphere(orientations, seed)
    parts, labels = [], []
    for k in range(orientations):
        parts.append(np.tile(up[k], (still, 1)))
        labels += [k] * still
        if k + 1 < orientations:
            way = np.linspace(0, 1, moving)[:, None]
            between = up[k] * (1 - way) + up[k + 1] * way + 0.3 * np.sin(20 * way)
            parts.append(between)
            labels += [-1] * moving
    vectors = GRAVITY * np.concatenate(parts)
    table: Document = {"time_s": [j / rate_hz for j in range(len(vectors))]}
    if labelled:
        table["position"] = labels
    for i, sensor in enumerate(true):
        table[sensor.name] = noisy(response(sensor, vectors), noise * sensor.scale, seed * 1000 + i)
    return {
        "format": "imu-session/1",
        "unit": "LOG-1",
        "block": "accelerometer",
        "programme": "arbitrary-orientations",
        "started_at": "2026-03-04T09:00:00Z",
        "site": {"gravity_m_s2": GRAVITY},
        "sample_rate_hz": rate_hz,
        "sensors": declared(true, "V"),
        "table": table,
    }


def mixed_block(m: int = 3, *, positions: int = 12) -> Document:
    """Accelerometers and pulse gyros of one block on the stand, m of each."""
    document, gyros = accelerometer_block(m, positions=positions), gyro_block(m, positions=positions)
    document["stand"] |= {"chi_deg": gyros["stand"]["chi_deg"]}
    document["count_time_s"] = gyros["count_time_s"]
    document["sensors"] += [sensor | {"kind": "gyroscope"} for sensor in gyros["sensors"]]
    document["table"] |= {name: gyros["table"][name] for name in gyros["table"] if name.startswith("G")}
    return document


EVERY = (accelerometer_block, gyro_block, mixed_block, arbitrary_orientations, raw_log)
"""One of every kind of session file."""
