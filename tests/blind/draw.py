"""Draws all of a session at random but the effect: unit, stand, site, noise."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from tests.blind.effects_sensor import across
from tests.blind.schedule import Wanted, draw_schedule
from tests.blind.world import ARCSEC, STANDARD_G, Array, Noise, Schedule, Session, Site, Stand, StandSigma, Unit

DEGREE = np.pi / 180
DEG_PER_HOUR = DEGREE / 3600
PULSE = 0.6 * ARCSEC
ONE_RUN = 0.15
"""Share of sessions with a single run, where the effect allows it."""


@dataclass(frozen=True)
class Arrangement:
    """Kinds of sensors in a block."""

    accelerometers: int
    gyros: int
    count_time: float | None = None


def draw_arrangement(rng: np.random.Generator, needs: frozenset[str]) -> Arrangement:
    """Mostly six accelerometers; gyros as rates, as pulses or beside accelerometers."""
    m = int(rng.choice([6] * 12 + [4, 5, 7, 8, 9, 10, 12, 8]))
    kind = rng.choice(["accelerometer", "rate", "pulse", "mixed"], p=[0.64, 0.12, 0.12, 0.12])
    if "gyros" in needs and kind == "accelerometer":
        kind = rng.choice(["rate", "pulse", "mixed"])
    elif "accelerometers" in needs and kind in ("rate", "pulse"):
        kind = "accelerometer"
    if kind == "mixed":
        return Arrangement(int(rng.integers(3, 7)), int(rng.integers(3, 7)))
    if kind == "accelerometer":
        return Arrangement(m, 0)
    return Arrangement(0, m, float(rng.choice([60.0, 100.0, 200.0])) if kind == "pulse" else None)


def draw_axes(m: int, rng: np.random.Generator) -> Array:
    """(m, 3) nominal axes, dimensionless: a cone anyhow, dodecahedron normals, or a triad with skewed axes."""
    form = rng.choice(["cone", "dodecahedron", "skew"], p=[0.6, 0.2, 0.2]) if m <= 6 else "cone"
    turn = Rotation.random(random_state=rng) if rng.random() < 0.7 else Rotation.identity()
    if form == "dodecahedron":
        angle = np.arctan(2.0)
        ring = [
            [np.sin(angle) * np.cos(a), np.cos(angle), np.sin(angle) * np.sin(a)] for a in np.arange(5) * 0.4 * np.pi
        ]
        axes = np.array([[0.0, 1.0, 0.0], *ring])[rng.permutation(6)[:m]]
    elif form == "skew":
        axes = np.vstack([np.eye(3), rng.normal(size=(3, 3))])[:m]
        turn = Rotation.from_rotvec(rng.normal(0, 0.3, 3)) * turn
    else:
        half, start = rng.uniform(35, 65) * DEGREE, rng.uniform(0, 2 * np.pi)
        around = start + 2 * np.pi * np.arange(m) / m
        axes = np.stack(
            [np.sin(half) * np.cos(around), np.full(m, np.cos(half)), np.sin(half) * np.sin(around)], axis=1
        )
    axes = turn.apply(axes / np.linalg.norm(axes, axis=1)[:, None])
    return axes if np.linalg.svd(axes, compute_uv=False)[-1] > 0.25 else draw_axes(m, rng)


def _kind_of_sensor(m: int, gyro: bool, count_time: float | None, rng: np.random.Generator) -> dict[str, Array]:
    """True and nominal parameters of m sensors of one kind."""
    nominal = draw_axes(m, rng)
    axis = np.array([_misaligned(e, rng) for e in nominal])
    if gyro:
        scale = np.full(m, count_time / PULSE if count_time else rng.choice([1.0, 1e3, 2.5e5]))
        bias = rng.normal(0, 2 * DEG_PER_HOUR, m)
        quadratic = np.zeros(m)
    else:
        scale = np.full(m, rng.choice([0.12, 1.0, 20.0, 1e4]))
        bias = rng.uniform(-5e-3, 5e-3, m) * STANDARD_G
        quadratic = rng.uniform(-2e-5, 2e-5, m) / STANDARD_G
    return {
        "gyro": np.full(m, gyro),
        "nominal_axis": nominal,
        "nominal_scale": scale,
        "scale": scale * (1 + rng.uniform(-0.01, 0.01, m)),
        "bias": bias,
        "quadratic": quadratic,
        "axis": axis,
    }


def _misaligned(axis: Array, rng: np.random.Generator) -> Array:
    p, o = across(axis)
    angle, way = rng.uniform(0, 0.5) * DEGREE, rng.uniform(0, 2 * np.pi)
    return np.cos(angle) * axis + np.sin(angle) * (np.cos(way) * p + np.sin(way) * o)


def draw_unit(arrangement: Arrangement, rng: np.random.Generator) -> Unit:
    """A unit with its true parameters."""
    accelerometers, gyros = arrangement.accelerometers, arrangement.gyros
    parts = []
    if accelerometers:
        parts.append(_kind_of_sensor(accelerometers, False, None, rng))
    if gyros:
        parts.append(_kind_of_sensor(gyros, True, arrangement.count_time, rng))
    joined = {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}
    pulse = "pulse" if arrangement.count_time else "V"
    return Unit(
        name=f"BU-{rng.integers(1000):03d}",
        names=tuple([f"A{i + 1}" for i in range(accelerometers)] + [f"G{i + 1}" for i in range(gyros)]),
        reading_unit=tuple(["V"] * accelerometers + [pulse] * gyros),
        **joined,
    )


def draw_noise(unit: Unit, count_time: float | None, rng: np.random.Generator) -> Noise:
    """Reading noise and bias repeatability at the input."""
    micro_g = 1e-6 * STANDARD_G
    reading = np.exp(rng.uniform(np.log(0.3), np.log(10))) * micro_g * rng.uniform(0.7, 1.4, unit.size)
    wander = rng.uniform(0, 20) * micro_g * np.ones(unit.size)
    gyro_reading = np.exp(rng.uniform(np.log(0.002), np.log(0.03))) * DEG_PER_HOUR * rng.uniform(0.7, 1.4, unit.size)
    gyro_wander = rng.uniform(0, 0.03) * DEG_PER_HOUR * np.ones(unit.size)
    if count_time:
        gyro_reading = np.hypot(np.maximum(gyro_reading, 0.4 / unit.scale), np.sqrt(1 / 12) / unit.scale)
    return Noise(
        reading=np.where(unit.gyro, gyro_reading, reading),
        repeatability=np.where(unit.gyro, gyro_wander, wander) * (rng.random() < 0.85),
        stated=bool(rng.random() < 0.85),
    )


def draw_stand(site: Site, rng: np.random.Generator) -> Stand:
    """A stand whose head is raised in the meridian, so that α fixes χ."""
    better = np.exp(rng.uniform(np.log(0.3), np.log(5)))
    sigma = StandSigma(*(better * ARCSEC * s for s in (0.33, 0.33, 1.0, 1.0) * rng.uniform(0.5, 2, 4)))
    alpha = rng.uniform(30, 55) * DEGREE
    chi = np.pi / 2 - abs(site.latitude - alpha)
    if chi > 70 * DEGREE:
        chi = alpha
    return Stand(f"ODG-{rng.integers(1, 9)}", alpha, chi, sigma)


def draw_mounting(rng: np.random.Generator) -> Array:
    """(3, 3) rotation, dimensionless: identity, the published fixture, or anyhow."""
    form = rng.random()
    if form < 0.4:
        return np.eye(3)
    return (
        np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]]) if form < 0.7 else Rotation.random(random_state=rng).as_matrix()
    )


def draw_site(rng: np.random.Generator) -> Site:
    """Somewhere between the tropics and the arctic circle; g measured now and then."""
    latitude, height = rng.uniform(25, 66) * DEGREE, rng.uniform(0, 1500)
    return Site(latitude, height, float(rng.uniform(9.79, 9.825)) if rng.random() < 0.2 else None)


def draw_session(rng: np.random.Generator, needs: frozenset[str] = frozenset(), longest: int = 36) -> Session:
    """A session that holds what the effect needs, of at most ``longest`` positions a run."""
    arrangement = draw_arrangement(rng, needs)
    unit = draw_unit(arrangement, rng)
    site = draw_site(rng)
    wanted = Wanted.drawn(rng, needs, one_run=ONE_RUN, most=_most(unit, longest))
    noise = draw_noise(unit, arrangement.count_time, rng)
    return Session(
        unit=unit,
        schedule=shaken(draw_schedule(wanted, rng), "vibration" in needs, rng),
        site=site,
        stand=draw_stand(site, rng),
        mounting=draw_mounting(rng),
        noise=replace(noise, stated=noise.stated or "stated noise" in needs),
        started_at=f"2026-{rng.integers(3, 10):02d}-{rng.integers(1, 28):02d}T{rng.integers(6, 18):02d}:00:00Z",
        count_time=arrangement.count_time,
    )


def _most(unit: Unit, longest: int) -> int:
    """Fewer positions where there are many sensors: the covariance is that of all readings."""
    return min(20, longest) if unit.size > 8 else longest


def shaken(schedule: Schedule, watched: bool, rng: np.random.Generator) -> Schedule:
    """The schedule with what shakes the block at every row, where that is watched."""
    return replace(schedule, vibration=0.1 * rng.weibull(1.5, schedule.rows)) if watched else schedule


def draw_earlier(session: Session, rng: np.random.Generator, longest: int = 36) -> Session:
    """An earlier session of the same unit, on the same kind of schedule, the same day or long before."""
    needs = {"both runs"} | ({"time"} if session.schedule.timed else set())
    needs |= {"temperature"} if session.schedule.thermometer else set()
    wanted = Wanted.drawn(rng, frozenset(needs), one_run=0.0, most=_most(session.unit, longest))
    months = rng.integers(0, 24)
    same_day = rng.random() < 0.2
    date = (
        f"{session.started_at[:10]}T00:30:00Z"
        if same_day
        else f"{2025 - months // 12}-{months % 12 + 1:02d}-11T09:00:00Z"
    )
    return replace(
        session,
        schedule=shaken(draw_schedule(wanted, rng), session.schedule.vibration is not None, rng),
        stand=session.stand if rng.random() < 0.5 else draw_stand(session.site, rng),
        started_at=date,
    )
