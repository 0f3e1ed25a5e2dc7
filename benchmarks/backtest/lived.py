"""The third generator: the parameters of the lives that whole tests live, as histories of the back-test."""

import numpy as np

from benchmarks.backtest.histories import STEP, YEARS, History
from tests.lives.generator.epochs import Epoch, epoch_of
from tests.lives.generator.kinds import KINDS, YEAR, course, temperature_law
from tests.lives.generator.life import Life, Move, Plan, draw_life, draw_type
from tests.lives.generator.workshop import draw_stands

GRID = np.round(STEP * YEAR * np.arange(round(YEARS / STEP))).astype(int)
"""Days of the points of a truth."""
DESCRIBED = KINDS


def lives(count: int, rng: np.random.Generator) -> list[Life]:
    """Units of one workshop with two sessions or more and without a service."""
    type_, stands, found = draw_type(1, "accelerometers", rng), draw_stands(rng), list[Life]()
    while len(found) < count:
        life = draw_life(f"LV-{len(found)}", type_, rng, Plan(services=0.0), stands)
        found += [life] if len(life.sessions) > 1 else []
    return found


def lived(life: Life, kinds: tuple[str, ...], rng: np.random.Generator) -> tuple[History, ...]:
    """Parameters of a life, each of a kind."""
    moves = [Move("A1", "bias", kind, course(kind, rng), temperature_law(kind, rng)) for kind in kinds]
    inside = list(range(len(life.sessions)))
    return tuple(_history(epoch_of(life, move, inside, rng)) for move in moves)


def _history(one: Epoch) -> History:
    """Dates to the nearest point of a truth."""
    time = STEP * np.round(one.days / YEAR / STEP)
    truth = one.truth[np.minimum(GRID, len(one.truth) - 1)]
    return History(one.kind, truth, 0.0, time, one.value, one.sigma, one.temperature)
