"""A hidden grammar of effects: what one sensor's input may do beyond every catalogue, as products of two factors.

Factors: the input a and what is across it as parts of the applied vector, its size and sign, powers of them, what it
was in the row before; the temperature, its rate, its square and what lags behind it; the time; waves of β. Arguments
and what is returned are those of `effects_sensor`. What the catalogue spans, or the calibration absorbs, is left out.
"""

from collections.abc import Callable
from itertools import combinations

import numpy as np

from tests.blind.effects_sensor import across, centred, late, smooth
from tests.blind.world import Array, Effect, Session

Drawn = tuple[Session, Effect, Array, Array]


def part(values: Array, n: Array) -> Array:
    """(R,) dimensionless: of the applied vector."""
    return values / float(np.linalg.norm(n, axis=1).mean())


def across_part(drawn: Drawn, which: int) -> Array:
    """(R,) dimensionless: p·n or o·n."""
    session, effect, n, _ = drawn
    return part(n @ across(session.unit.axis[effect.sensor])[which], n)


def row_before(drawn: Drawn) -> Array:
    """(R,) dimensionless: the input of the row before, 0 in the first row of a run."""
    session, _, n, a = drawn
    flipped = session.schedule.flipped
    first = np.concatenate([[True], flipped[1:] != flipped[:-1]])
    return np.where(first, 0.0, np.roll(part(a, n), 1))


def lagged(drawn: Drawn) -> Array:
    """(R,) °C: what follows the temperature with a time constant of the effect's first shape, s."""
    session, effect, _, _ = drawn
    return centred(late(session.schedule, effect.shape[0], smooth(session.schedule)))


FACTORS: dict[str, Callable[[Drawn], Array]] = {
    "1": lambda d: np.ones(len(d[3])),
    "a": lambda d: part(d[3], d[2]),
    "|a|": lambda d: np.abs(part(d[3], d[2])),
    "sign a": lambda d: np.sign(d[3]),
    "a²": lambda d: part(d[3], d[2]) ** 2,
    "a⁴": lambda d: part(d[3], d[2]) ** 4,
    "p": lambda d: across_part(d, 0),
    "o": lambda d: across_part(d, 1),
    "T": lambda d: centred(d[0].schedule.temperature),
    "T²": lambda d: centred(d[0].schedule.temperature) ** 2,
    "T³": lambda d: centred(d[0].schedule.temperature) ** 3,
    "dT/dt": lambda d: d[0].schedule.temperature_rate,
    "lag T": lagged,
    "t": lambda d: centred(d[0].schedule.time),
    "t²": lambda d: centred(d[0].schedule.time) ** 2,
    "before": row_before,
    "sin β": lambda d: np.sin(d[0].schedule.beta),
    "cos 2β": lambda d: np.cos(2 * d[0].schedule.beta),
    "sin 3β": lambda d: np.sin(3 * d[0].schedule.beta),
}

SPANNED = {
    *(("1", x) for x in ("a", "|a|", "sign a", "a²", "p", "o", "T", "T²", "dT/dt", "lag T", "t", "sin β")),
    *(("a", x) for x in ("|a|", "sign a", "a²", "p", "o", "T", "t")),
    *(("|a|", x) for x in ("sign a",)),
    *(("sign a", x) for x in ("a²",)),
    ("p", "t"),
    ("o", "t"),
    ("p", "o"),
    ("T", "T²"),
}
"""Pairs that a cause of the catalogue, or the calibration, has already, and one that is another pair again."""


def product(first: str, second: str) -> Callable[[Session, Effect, Array, Array, Array], Array]:
    """The effect k·first·second."""

    def added(session: Session, effect: Effect, n: Array, a: Array, force: Array) -> Array:
        drawn = (session, effect, n, a)
        return effect.k * FACTORS[first](drawn) * FACTORS[second](drawn)

    return added


GRAMMAR = {
    f"{x}·{y}": product(x, y) for x, y in combinations(FACTORS, 2) if (x, y) not in SPANNED and (y, x) not in SPANNED
}
"""Effects by their name, as Effect.cause holds it."""

WARM = tuple(name for name in GRAMMAR if "T" in name)
"""The effects that depend on temperature."""


def told_of(session: Session, name: str) -> bool:
    """Whether the file of a session states the variables of the effect."""
    schedule, words = session.schedule, name.split("·")
    timed = schedule.timed or not any(w in ("t", "t²", "lag T", "dT/dt") for w in words)
    return timed and (schedule.thermometer or name not in WARM)
