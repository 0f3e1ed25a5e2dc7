"""Sessions with grossly wrong readings, of known truth: written from the physics alone, as dictionaries."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

G = 9.80665
EARTH = 7.292115e-5
Array = np.ndarray
Slip = tuple[int, int]
"""Row and sensor, from 0."""


@dataclass(frozen=True, eq=False)
class Truth:
    """A session without errors of the record. R rows, m sensors."""

    programme: str
    names: tuple[str, ...]
    applied: Array
    """(R, m) input along the nominal axis, in units of its size."""
    readings: Array
    noise: Array
    """(m,) one sigma, reading units."""
    scale: Array
    bias: Array
    document: dict[str, Any]
    stated: bool
    full: Array
    """(m,) reading units of the full range."""

    def file(self) -> dict[str, Any]:
        """The session file as JSON has it."""
        table = dict(self.document["table"])
        for i, name in enumerate(self.names):
            table[name] = self.readings[:, i].tolist()
            if self.stated:
                table[f"{name}_se"] = [float(self.noise[i])] * len(self.readings)
        return self.document | {"table": table}


@dataclass(frozen=True, eq=False)
class Case:
    """A session with what is wrong about it."""

    truth: Truth
    gross: tuple[Slip, ...] = ()
    identifiable: bool = True
    suspects: dict[int, tuple[int, ...]] = field(default_factory=dict)


def unit(v: Array) -> Array:
    """Rows of length one."""
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def nominal_axes(m: int, rng: np.random.Generator) -> Array:
    """A triad, a cone, or any axes that span space well."""
    if m == 3:
        return np.eye(3)
    if rng.random() < 0.5:
        turn = 2 * np.pi * np.arange(m) / m
        half = np.arccos(1 / np.sqrt(3))
        return np.column_stack([np.sin(half) * np.cos(turn), np.full(m, np.cos(half)), np.sin(half) * np.sin(turn)])
    while True:
        axes = unit(rng.standard_normal((m, 3)))
        others = [np.linalg.svd(np.delete(axes, i, axis=0), compute_uv=False)[2] for i in range(m)]
        if min(others) > 0.4:
            return axes


def misaligned(axes: Array, rng: np.random.Generator, size: float) -> Array:
    """The axes misaligned at random by ``size``, without a net turn against ``axes``, as orientations cannot show
    one.
    """
    moved = unit(axes + size * rng.standard_normal(axes.shape))
    U, _, Vt = np.linalg.svd(axes.T @ moved)
    return moved @ (U @ np.diag([1, 1, np.linalg.det(U @ Vt)]) @ Vt).T


def stand(rng: np.random.Generator) -> Truth:
    """Two-axis stand: one run or two, accelerometers or gyros, stand errors common to all."""
    gyro, m, N = rng.random() < 0.2, int(rng.integers(3, 9)), int(rng.integers(12, 37))
    runs = 1 if N >= 18 and rng.random() < 0.25 else 2
    alpha = rng.uniform(30, 50)
    axes = nominal_axes(m, rng)
    true, arcsec = misaligned(axes, rng, 2e-3), np.pi / 180 / 3600
    beta = np.tile(np.radians(np.round(360.0 * np.arange(N) / N, 4)), runs)
    flip = np.repeat(np.arange(runs) > 0, N)
    off = beta + arcsec * rng.standard_normal(len(beta))
    tilt_x, tilt_y, lift = arcsec * rng.standard_normal(3) * [1 / 3, 1 / 3, 1.0]
    rise = np.radians(alpha) + lift + tilt_x
    off = off - tilt_y / np.cos(rise)
    n = np.column_stack([-np.cos(rise) * np.sin(off), np.full(len(off), np.sin(rise)), np.cos(rise) * np.cos(off)])
    n = np.where(flip[:, None], n * [-1, -1, 1], n)
    size = EARTH if gyro else G
    scale_nominal, kind = (2000.0, "gyroscope") if gyro else (0.12, "accelerometer")
    scale = scale_nominal * (1 + 0.01 * rng.standard_normal(m))
    bias = size * (0.05 if gyro else 0.005) * rng.standard_normal(m)
    noise = scale_nominal * size * 10 ** rng.uniform(-5.3, -4.5) * np.ones(m) * (100 if gyro else 1)
    a = size * n @ true.T
    quadratic = 0.0 if gyro else 2e-5 * rng.standard_normal(m) / G
    readings = scale * (a + bias + quadratic * a * a) + noise * rng.standard_normal(a.shape)
    names = tuple(f"{'G' if gyro else 'A'}{i + 1}" for i in range(m))
    document = {
        "format": "imu-session/1", "unit": "gross", "block": kind, "programme": "two-axis-stand",
        "started_at": "2026-01-12T09:00:00Z", "site": {"latitude_deg": 55.0, "gravity_m_s2": G},
        "stand": {
            "id": "S", ("chi_deg" if gyro else "alpha_deg"): alpha,
            "sigma_arcsec": {"theta_x": 1 / 3, "theta_y": 1 / 3, "alpha": 1.0, "beta": 1.0},
        },
        "sensors": sensors(names, axes, scale_nominal),
        "table": {"beta_deg": np.degrees(beta).tolist(), "run": ["flipped" if f else "direct" for f in flip]},
    }  # fmt: skip
    full = np.full(m, 2 * scale_nominal * size)
    return Truth("stand", names, a / size, readings, noise, scale, bias, document, rng.random() < 0.6, full)


def sensors(names: tuple[str, ...], axes: Array, scale: float) -> list[dict[str, Any]]:
    """The sensors as a session file describes them."""
    return [
        {"name": name, "nominal_axis": axis.tolist(), "nominal_scale": scale, "reading_unit": "V"}
        for name, axis in zip(names, axes, strict=True)
    ]


def orientations(rng: np.random.Generator, triad: bool | None = None) -> Truth:
    """Arbitrary orientations, some of them repeated."""
    m = 3 if triad or (triad is None and rng.random() < 0.3) else int(rng.integers(4, 9))
    R = int(rng.integers(14 if m == 3 else 12, 41))
    d = unit(rng.standard_normal((R, 3)))
    if rng.random() < 0.2:
        d[R // 2 : 2 * (R // 2)] = unit(d[: R // 2] + 0.01 * rng.standard_normal((R // 2, 3)))
    axes = nominal_axes(m, rng)
    true = misaligned(axes, rng, 5e-3)
    scale, bias = 0.12 * (1 + 0.01 * rng.standard_normal(m)), 0.05 * rng.standard_normal(m)
    noise = np.full(m, 0.12 * G * 10 ** rng.uniform(-5, -3.7))
    a = G * d @ true.T
    readings = scale * (a + bias) + noise * rng.standard_normal(a.shape)
    names = tuple(f"A{i + 1}" for i in range(m))
    document = {
        "format": "imu-session/1", "unit": "gross", "block": "accelerometer", "programme": "arbitrary-orientations",
        "started_at": "2026-01-12T09:00:00Z", "site": {"latitude_deg": 55.0, "gravity_m_s2": G},
        "sensors": sensors(names, axes, 0.12), "table": {},
    }  # fmt: skip
    full = np.full(m, 2 * 0.12 * G)
    return Truth("orientations", names, a / G, readings, noise, scale, bias, document, rng.random() < 0.6, full)


def raw(rng: np.random.Generator) -> Case:
    """A raw log of rests on a stand or in orientations; a channel is unplugged in one of them."""
    truth = (stand if rng.random() < 0.3 else orientations)(rng)
    R, m = truth.readings.shape
    rest, rate = 150, 50.0
    j, i = int(rng.integers(R)), int(rng.integers(m))
    samples = np.repeat(truth.readings, rest, axis=0)
    samples = samples + 10 * truth.noise * rng.standard_normal(samples.shape)
    samples[j * rest : (j + 1) * rest, i] = rng.choice([0.0, 2.5, -0.013])
    table = {key: np.repeat(column, rest).tolist() for key, column in truth.document["table"].items()}
    if truth.programme == "orientations":
        table["position"] = np.repeat(np.arange(R), rest).tolist()
    document = truth.document | {"sample_rate_hz": rate, "table": table}
    whole = replace(truth, readings=samples, document=document, stated=False)
    right = np.sum(np.delete(truth.applied[j], i) ** 2) + (np.mean(samples[j * rest, i]) / truth.scale[i] / G) ** 2
    return Case(whole, ((j, i),), m > 3 or truth.programme == "stand" or right > 1.0)


def slip(truth: Truth, rng: np.random.Generator, j: int, i: int, least: float) -> tuple[float, bool]:
    """A wrong reading, ``least`` standard errors off at least, and whether it is one of the slips of writing."""
    u, right = truth.readings, truth.readings[j, i]
    others = [k for k in range(u.shape[1]) if k != i]
    ways = [0.0, -right, right * 10, right / 10, float(u[j, rng.choice(others)]), float(u[max(j - 1, 0), i])]
    if rng.random() < 0.5:
        wrong = float(rng.choice(ways))
        if abs(wrong - right) > max(least, 30) * truth.noise[i]:
            return wrong, True
    size = np.exp(rng.uniform(np.log(least * truth.noise[i]), np.log(truth.full[i])))
    return right + size * rng.choice([-1, 1]), False


def with_gross(truth: Truth, places: list[Slip], rng: np.random.Generator, least: float) -> Case:
    """The session with wrong readings in some places."""
    readings, plain = truth.readings.copy(), True
    for j, i in places:
        readings[j, i], of_writing = slip(truth, rng, j, i, least)
        plain &= of_writing
    case = Case(replace(truth, readings=readings), tuple(places))
    return replace(case, identifiable=all(can_tell(case, j) for j, _ in places))


def can_tell(case: Case, j: int) -> bool:
    """Whether a row's gravity leaves but one reading that can be wrong: always on a stand and with redundancy; of three
    orthogonal ones where the other two, with the wrong one, are longer than gravity."""
    truth = case.truth
    if truth.programme == "stand" or truth.readings.shape[1] > 3:
        return True
    along = truth.readings[j] / truth.scale / G
    wrong = [i for row, i in case.gross if row == j]
    return all(sum(along[k] ** 2 for k in range(3) if k != other) > 1.01 for other in range(3) if other not in wrong)


def single(rng: np.random.Generator, draw: Callable[[np.random.Generator], Truth]) -> Case:
    """One, from 6 standard errors to the full range."""
    truth = draw(rng)
    R, m = truth.readings.shape
    return with_gross(truth, [(int(rng.integers(R)), int(rng.integers(m)))], rng, 6.0)


def three(rng: np.random.Generator, draw: Callable[[np.random.Generator], Truth]) -> Case:
    """Three in different rows, of any sensors."""
    truth = draw(rng)
    R, m = truth.readings.shape
    rows = rng.choice(R, 3, replace=False)
    return with_gross(truth, [(int(j), int(rng.integers(m))) for j in rows], rng, 20.0)


def tenth(rng: np.random.Generator, draw: Callable[[np.random.Generator], Truth]) -> Case:
    """A tenth of one sensor's readings."""
    truth = draw(rng)
    R, m = truth.readings.shape
    i, rows = int(rng.integers(m)), rng.choice(R, max(1, R // 10), replace=False)
    return with_gross(truth, [(int(j), i) for j in rows], rng, 20.0)


def frozen(rng: np.random.Generator, draw: Callable[[np.random.Generator], Truth]) -> Case:
    """A channel that stands still for four to eight rows."""
    truth = draw(rng)
    R, m = truth.readings.shape
    length, i = int(rng.integers(4, min(9, R // 4 + 2))), int(rng.integers(m))
    first = int(rng.integers(R - length))
    readings = truth.readings.copy()
    readings[first + 1 : first + length, i] = readings[first, i]
    case = Case(replace(truth, readings=readings), tuple((j, i) for j in range(first + 1, first + length)))
    return replace(case, identifiable=all(can_tell(case, j) for j, _ in case.gross))


def sound(rng: np.random.Generator, draw: Callable[[np.random.Generator], Truth]) -> Case:
    """No wrong reading; in four of six an effect, of 8 to 60 standard errors."""
    truth = draw(rng)
    u, (R, m) = truth.readings.copy(), truth.readings.shape
    i, kind, strength = int(rng.integers(m)), int(rng.integers(6)), rng.uniform(8, 60)
    size = strength * truth.noise[i]
    if kind == 1:
        u[int(rng.integers(2, R - 2)) :, i] += size / np.sqrt(R) * rng.choice([-1, 1]) * 2
    elif kind == 2:
        u[:, i] += size * truth.applied[:, i] ** 2 / np.linalg.norm(truth.applied[:, i] ** 2)
    elif kind == 3:
        turn = np.sin(2 * np.pi * np.arange(R) / R * 2)
        u += (size / np.linalg.norm(turn) * turn)[:, None] * np.sqrt(1 - np.minimum(truth.applied**2, 1.0))
    elif kind == 4:
        u += truth.noise * (rng.standard_t(4, u.shape) / np.sqrt(2) - rng.standard_normal(u.shape))
    elif kind == 5:
        behind = np.sign(np.gradient(truth.applied[:, i]))
        u[:, i] += size * behind / np.linalg.norm(behind)
    return Case(replace(truth, readings=u))
