"""Sound units whose biases and scales follow the temperature, and units that changed at the same temperature."""

from dataclasses import replace
from typing import Any

import numpy as np

from tests.blind.draw import Arrangement, draw_mounting, draw_noise, draw_site, draw_stand, draw_unit
from tests.blind.physics import measure
from tests.blind.schedule import Wanted, draw_schedule
from tests.blind.world import STANDARD_G, Array, Session
from tests.blind.write import session_file

ROOM = 20.0
MICRO_G, PPM = 1e-6 * STANDARD_G, 1e-6
WANDER = 0.3
"""°C, to and fro within a session."""


def draw_unit_at_room(rng: np.random.Generator) -> Session:
    """Four accelerometers on a stand, at 20 °C."""
    unit, site = draw_unit(Arrangement(4, 0), rng), draw_site(rng)
    wanted = Wanted(int(rng.integers(10, 13)), (False, True), True, False, "constant", True, True)
    noise = replace(draw_noise(unit, None, rng), stated=True)
    return Session(unit, draw_schedule(wanted, rng), site, draw_stand(site, rng), draw_mounting(rng), noise)


def draw_law(m: int, rng: np.random.Generator, *, curved: bool) -> Array:
    """(2, m, 2) line and parabola of bias, m/s² per K and K², and scale, relative: worth 150 µg and 300 ppm in 15 K."""
    line = np.stack([rng.normal(0, 10 * MICRO_G, m), rng.normal(0, 20 * PPM, m)])
    curve = np.stack([rng.normal(0, 0.7 * MICRO_G, m), rng.normal(0, 1.4 * PPM, m)])
    return np.stack([0.2 * line if curved else line, curve if curved else 0 * curve], axis=-1)


def at_temperature(
    world: Session,
    law: Array,
    celsius: float,
    day: str,
    rng: np.random.Generator,
    wander: float = WANDER,
    lag: float = 0.0,
) -> dict[str, Any]:
    """The file of a session of a unit that obeys a law, measured at a temperature on some day; its sensors are warmer
    than the file says by ``lag``, °C."""
    rows = world.schedule.rows
    warm = np.round(celsius + wander * np.sin(np.linspace(0, 2 * np.pi, rows) + rng.uniform(0, 6)), 2)
    world = replace(world, schedule=replace(world.schedule, temperature=warm), started_at=f"{day}T09:00:00Z")
    away = warm[:, None] + lag - ROOM
    bias, scale = (part[:, 0] * away + part[:, 1] * away**2 for part in law)
    inside = measure(world, (), rng)[0] / world.unit.scale
    return session_file(world, world.unit.scale * (1 + scale) * (inside + bias))


def stepped(world: Session, rng: np.random.Generator) -> tuple[Session, str]:
    """The unit after one sensor's bias has moved by 150 µg, and that sensor's name."""
    i = int(rng.integers(world.unit.size))
    bias = world.unit.bias + 150 * MICRO_G * rng.choice([-1.0, 1.0]) * np.eye(world.unit.size)[i]
    return replace(world, unit=replace(world.unit, bias=bias)), world.unit.names[i]
