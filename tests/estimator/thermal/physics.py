"""Blocks over temperature by the law of physics alone, u = u₀ + K(T)·(a + b(T) + c·a²), held still; as files."""

from dataclasses import dataclass, field

import numpy as np

from estimator.json_object import Json
from estimator.session import Array

G, EARTH = 9.81, 7.292115e-5
"""m/s²; rad/s."""
SOAKS = (20.0, -40.0, -10.0, 20.0, 45.0, 70.0, 45.0, 20.0, -10.0)
"""°C."""


@dataclass(frozen=True)
class Still:
    """A session of accelerometers A1 to A6, two of one kind alike in nothing, and of gyros G1, G2, …"""

    soaks: tuple[float, ...] = SOAKS
    each: int = 9
    noise: float = 1e-3
    """m/s²."""
    gyro_noise: float = 1e-5
    """rad/s."""
    stated: bool = True
    known: float | None = None
    """One sigma of stated directions, rad."""
    offset: float = 0.0
    """u₀, V."""
    quadratic: float = 2e-5
    """c of A1, s²/m; every next sensor's has the other sign."""
    bend: tuple[float, float] = (4e-7, 4e-6)
    """Second-order coefficients of K and b: V per m/s² per K², m/s² per K²."""
    loop: float = 0.0
    """m/s², of A1 to A3."""
    lag: float = 0.0
    """m/s² per K, of A1 to A3."""
    tau: float = 1500.0
    """s."""
    gyros: int = 0
    dead: bool = False
    """A6 answers to nothing."""
    scale: Array = field(default_factory=lambda: np.array([0.12, 0.12, 0.12, 0.3, 0.3, 0.3]))
    """Nominal, V per m/s²; of a gyro 50 V per rad/s."""
    gravity: float = G


GYRO_SCALE = 50.0


@dataclass(frozen=True, eq=False)
class Truly:
    """The truth: powers of T − 20, axes, applied directions, temperatures and times."""

    scale: Array
    bias: Array
    quadratic: Array
    axes: Array
    gyro_bias: Array
    up: Array
    temperature: Array
    time: Array


def unit(v: Array) -> Array:
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))


def cone(m: int) -> Array:
    """(m, 3) nominal axes about Z."""
    turn = 2 * np.pi * np.arange(m) / m + 0.2
    return np.stack([0.8 * np.cos(turn), 0.8 * np.sin(turn), np.full(m, 0.6)], axis=1)


def behind(temperature: Array, time: Array, tau: float) -> Array:
    """(R,) K by which a body of one heat capacity is behind, from small steps of Euler's method."""
    fine = np.linspace(time[0], time[-1], 40 * len(time) * max(1, int(np.ptp(time) / len(time) / tau) + 1))
    T, L = np.interp(fine, time, temperature), np.zeros(len(fine))
    L[0] = T[0]
    step = np.exp(-(fine[1] - fine[0]) / tau)
    for i in range(1, len(fine)):
        L[i] = (T[i] + T[i - 1]) / 2 + (L[i - 1] - (T[i] + T[i - 1]) / 2) * step
    return np.interp(time, fine, L) - temperature


def lived(case: Still, rng: np.random.Generator) -> tuple[Json, Truly]:
    """A file, and what is so."""
    m, R = 6, len(case.soaks) * case.each
    axes = unit(cone(m) + 1e-3 * rng.standard_normal((m, 3)))
    up = unit(rng.standard_normal((R, 3)))
    T = np.repeat(case.soaks, case.each) + 0.2 * rng.standard_normal(R)
    time = 120.0 * np.arange(R) + 3000.0 * (np.arange(R) // case.each)
    K = case.scale[:, None] * np.column_stack([1 + 2e-3 * rng.standard_normal(m), rng.choice([-1, 1], m) * 6e-5,
                                               case.bend[0] * rng.choice([-1, 1], m)])  # fmt: skip
    b = np.column_stack([0.02 * rng.standard_normal(m), rng.choice([-1, 1], m) * 6e-4,
                         case.bend[1] * rng.choice([-1, 1], m)])  # fmt: skip
    c = case.quadratic * (-1.0) ** np.arange(m)
    z, x = np.vander(T - 20, 3, increasing=True), 2 * (T - T.min()) / np.ptp(T) - 1
    leg = np.repeat(np.sign(np.diff(case.soaks, prepend=case.soaks[0])), case.each)
    beside = case.loop * leg * (1 - x**2) / 2 + case.lag * (behind(T, time, case.tau) if case.lag else 0.0)
    table: Json = {"time_s": time.tolist(), "temperature_c": T.tolist()}
    sensors = []
    for i in range(m):
        a = case.gravity * up @ axes[i]
        sigma = abs(case.scale[i]) * case.noise
        u = z @ K[i] * (a + z @ b[i] + c[i] * a**2 + beside * (i < 3)) + sigma * rng.standard_normal(R) + case.offset
        if case.dead and i == m - 1:
            u = np.full(R, case.offset)
        table |= {f"A{i + 1}": u.tolist()} | ({f"A{i + 1}_se": [sigma] * R} if case.stated else {})
        own = {"name": f"A{i + 1}", "nominal_axis": cone(m)[i].tolist(), "nominal_scale": case.scale[i]}
        sensors.append(own | {"reading_unit": "V"} | ({"nominal_offset": case.offset} if case.offset else {}))
    spin = EARTH * unit(rng.standard_normal((R, 3)))
    gyro_bias = np.array([[1e-3, -2e-5, 1e-7]]) * (1 + np.arange(case.gyros))[:, None]
    for i in range(case.gyros):
        w = spin @ cone(3)[i] + z @ gyro_bias[i] + case.gyro_noise * rng.standard_normal(R)
        own = {"name": f"G{i + 1}", "kind": "gyroscope", "nominal_axis": cone(3)[i].tolist()}
        sensors.append(own | {"nominal_scale": GYRO_SCALE, "reading_unit": "V"})
        table |= {f"G{i + 1}": (GYRO_SCALE * w).tolist()}
        table |= {f"G{i + 1}_se": [GYRO_SCALE * case.gyro_noise] * R} if case.stated else {}
    document: Json = {
        "format": "imu-session/1", "unit": "STILL", "block": "accelerometer",
        "programme": "thermal", "site": {"gravity_m_s2": case.gravity}, "sensors": sensors, "table": table,
    }  # fmt: skip
    if case.known is not None:
        stated = unit(up + case.known * rng.standard_normal((R, 3)))
        document["direction_sigma_deg"] = float(np.degrees(case.known))
        table |= {f"direction_{k}": stated[:, j].tolist() for j, k in enumerate("xyz")}
    return document, Truly(K, b, c, axes, gyro_bias, up, T, time)
