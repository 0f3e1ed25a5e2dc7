"""Bounds of gravity and sensors: later sessions whose scale factors all changed by one factor, judged by the service.

``python -m benchmarks.study.seen.bounds 200 1``: units by a generator of their own, on a stand or in orientations.
Beyond the bound the factor is the unit's supply, reference or range: its session must not be fit, and the sound session
after it must be. Where the file states another latitude, rightly or by a slip of up to three degrees, gravity explains
the factor: fit as ever. The sound session of every unit counts for false alarms.
"""

import json
import sys
import tempfile
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.study.rates import Rate, rate
from benchmarks.study.report import table as markdown
from service.opening import open_database
from service.sessions.decision import Verdict
from service.storage import Files, Storage
from service.uploads.receive import upload
from tests.databases import sqlite_databases

Array = NDArray[np.float64]
NOW = datetime(2026, 11, 21, tzinfo=UTC)
FIT = (Verdict.PASS, Verdict.CONDITIONAL_PASS)
KINDS = ("beyond", "moved", "slip", "sound")
NOISE = 2e-5
"""m/s², one sigma of an averaged reading."""


def normal_gravity(latitude: float, height: float) -> float:
    """m/s², Somigliana's formula of GRS 80 with the free-air gradient; latitude in degrees."""
    sine = np.sin(np.radians(latitude)) ** 2
    size = 9.7803267715 * (1 + 0.001931851353 * sine) / np.sqrt(1 - 0.0066943800229 * sine)
    return float(size - 3.086e-6 * height)


@dataclass(frozen=True)
class Unit:
    """True sensors and how they are measured."""

    serial: str
    on_stand: bool
    axes: Array
    """(m, 3) unit vectors, dimensionless."""
    scale: Array
    """(m,) V per m/s²."""
    bias: Array
    """(m,) m/s²."""
    latitude: float
    """Degrees."""
    alpha: float
    """rad."""
    rows: Array
    """(R, 3) directions of the specific force, block axes, dimensionless."""
    beta: Array
    """(R,) degrees, of a stand."""


def drawn(number: int, rng: np.random.Generator) -> Unit:
    """A unit of six or eight sensors on a cone."""
    m, half = int(rng.choice([6, 8])), rng.uniform(0.8, 1.1)
    turn = 2 * np.pi * np.arange(m) / m
    axes = np.column_stack([np.sin(half) * np.cos(turn), np.full(m, np.cos(half)), np.sin(half) * np.sin(turn)])
    axes += 1e-4 * rng.standard_normal(axes.shape)
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    on_stand, alpha, n = bool(rng.random() < 0.5), rng.uniform(0.5, 0.9), 24
    beta = np.arange(n) * 360.0 / n
    b = np.radians(beta)
    turned = np.column_stack([-np.cos(alpha) * np.sin(b), np.full(n, np.sin(alpha)), np.cos(alpha) * np.cos(b)])
    free = rng.standard_normal((40, 3))
    rows = np.vstack([turned, turned * [-1, -1, 1]]) if on_stand else free / np.linalg.norm(free, axis=1, keepdims=True)
    scale, bias = 0.12 * (1 + 0.01 * rng.standard_normal(m)), 0.02 * rng.standard_normal(m)
    return Unit(f"U-{number:05d}", on_stand, axes, scale, bias, rng.uniform(-60, 60), alpha, rows, np.tile(beta, 2))


def session(
    unit: Unit, day: int, rng: np.random.Generator, true: float, stated: float | None = None, factor: float = 1.0
) -> bytes:
    """A session file; latitudes in degrees, ``factor`` multiplies all scale factors."""
    inputs = normal_gravity(true, 100.0) * unit.rows @ unit.axes.T + unit.bias
    noise = NOISE * rng.standard_normal(inputs.shape)
    readings = factor * unit.scale * (inputs + noise)
    table: dict[str, Any] = {}
    for i in range(len(unit.scale)):
        table[f"A{i + 1}"] = readings[:, i].tolist()
        table[f"A{i + 1}_se"] = [NOISE * float(unit.scale[i])] * len(readings)
    document: dict[str, Any] = {
        "format": "imu-session/1", "unit": unit.serial, "block": "accelerometer", "origin": "simulated",
        "programme": "two-axis-stand" if unit.on_stand else "arbitrary-orientations",
        "started_at": (datetime(2026, 1, 1, 9, tzinfo=UTC) + timedelta(days=day)).isoformat(),
        "site": {"latitude_deg": true if stated is None else stated, "height_m": 100.0},
        "sensors": [
            {"name": f"A{i + 1}", "nominal_axis": axis.tolist(), "nominal_scale": 0.12, "reading_unit": "V"}
            for i, axis in enumerate(unit.axes)
        ],
    }  # fmt: skip
    if unit.on_stand:
        document["stand"] = {"id": "S", "alpha_deg": float(np.degrees(unit.alpha)), "sigma_arcsec": {"alpha": 1.0}}
        half = len(unit.rows) // 2
        table |= {"run": ["direct"] * half + ["flipped"] * half, "beta_deg": unit.beta.tolist()}
    return json.dumps(document | {"table": table}).encode()


def later(unit: Unit, kind: str, rng: np.random.Generator) -> bytes:
    """The session between the reference and the sound one."""
    if kind == "beyond":
        size = np.exp(rng.uniform(np.log(5e-4), np.log(0.1))) * rng.choice([-1, 1])
        return session(unit, 30, rng, unit.latitude, factor=1 + size)
    if kind == "moved":
        return session(unit, 30, rng, unit.latitude + rng.uniform(-20, 20))
    if kind == "slip":
        return session(unit, 30, rng, unit.latitude, stated=unit.latitude + rng.uniform(-3, 3))
    return session(unit, 30, rng, unit.latitude)


def marks(storage: Storage, number: int, kind: str, rng: np.random.Generator) -> tuple[bool, bool]:
    """Whether the later session, and the sound one after it, are fit."""
    unit = drawn(number, rng)
    files = (session(unit, 0, rng, unit.latitude), later(unit, kind, rng), session(unit, 60, rng, unit.latitude))
    receipts = [upload(storage, content, "a.json", NOW, outlook=False) for content in files]
    return receipts[1].verdict in FIT, receipts[2].verdict in FIT


def table(n: int, seed: int) -> str:
    """n units of each kind, through the service's own judging on SQLite."""
    rows: list[tuple[str, Rate, Rate]] = []
    with sqlite_databases() as databases, tempfile.TemporaryDirectory() as folder:
        storage = Storage(open_database(databases.migrated()), Files(Path(folder)))
        for k, kind in enumerate(KINDS):
            found = [marks(storage, k * n + i, kind, np.random.default_rng([seed, k, i])) for i in range(n)]
            rows.append((kind, rate([fit for fit, _ in found]), rate([fit for _, fit in found])))
        storage.database.close()
    return markdown(("kind", "fit", "sound session after it fit"), rows)


if __name__ == "__main__":
    print(table(int(sys.argv[1]), int(sys.argv[2])))
