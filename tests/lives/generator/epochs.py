"""A life as histories of parameters: what each session says of a parameter, with the uncertainty that it states."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from tests.lives.generator.kinds import DAYS, STABLE, Array, Random
from tests.lives.generator.life import Life, Move

STATED = (0.02, 0.2)
"""T, least and largest one sigma of a parameter that a unit's sessions state; of one session a quarter either way."""


@dataclass(frozen=True, eq=False)
class Epoch:
    """One parameter from one break to the next, measured at least twice; deviations in tolerances."""

    kind: str
    days: Array
    """(n,) since the reference session."""
    value: Array
    """(n,) deviation from the reference as recorded: the error of the reference is in all of them but the first."""
    sigma: Array
    """(n,) sigma that each session states; of the reference its own."""
    temperature: Array
    """(n,) °C of the sessions."""
    truth: Array
    """(days,) true deviation from the recorded reference, from the reference on, as if no further service came, at the
    temperature of the hall."""


def epochs(life: Life, parameters: int, rng: Random) -> tuple[tuple[Epoch, ...], ...]:
    """The epochs that have two sessions or more, each of so many ``parameters``, the first of which is the moving
    one.
    """
    breaks = [0, *(one.day for one in life.services), DAYS[-1] + 1]
    found = []
    for start, end in pairwise(breaks):
        inside = [i for i, one in enumerate(life.sessions) if start <= one.day < end]
        if len(inside) > 1:
            moving = life.moves[0] if life.moves else None
            found.append(tuple(epoch_of(life, moving if i == 0 else None, inside, rng) for i in range(parameters)))
    return tuple(found)


def epoch_of(life: Life, move: Move | None, inside: list[int], rng: Random) -> Epoch:
    """One parameter of the sessions of one epoch; None where nothing moves."""
    sessions = [life.sessions[i] for i in inside]
    days = np.array([one.day for one in sessions])
    sigma = np.exp(rng.uniform(*np.log(STATED))) * rng.uniform(0.75, 1.25, len(days))
    error = sigma * rng.standard_normal(len(days))
    warm = np.array([one.temperature for one in sessions])
    true = np.zeros(len(days)) if move is None else np.array([move.at(d, w) for d, w in zip(days, warm, strict=True)])
    recorded = true[0] + error[0]
    air = life.stands[sessions[0].stand].air
    later = DAYS[days[0] :]
    whole = np.zeros(len(later)) if move is None else np.array([move.at(d, air[d]) for d in later])
    kind = STABLE if move is None else move.kind
    return Epoch(kind, (days - days[0]).astype(float), true + error - recorded, sigma, warm, whole - recorded)
