"""Values of columns → what they are: gravity at rest, turns that both triads saw, the unit and rate of a clock.

A triad of accelerometers at rest feels gravity, however it lies; a gyro next to it reads how that vector turns:
u' = −ω × u for the unit vector u of gravity in axes of the block. A regression of the turns of u on the gyros' sums
over short spans gives the factor from each gyro's unit to rad/s, and its sign.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.applied_vector import STANDARD_GRAVITY
from estimator.screening.clock import SAMPLES, rate_of, usual_step

Array = NDArray[np.float64]
GRAVITIES = {"m/s²": STANDARD_GRAVITY, "g": 1.0, "mg": 1000.0}
"""Length of gravity in the units that a table may leave unsaid."""
LIKE_GRAVITY = 0.15
"""Largest relative difference from gravity: biases and scale factors of cheap sensors stay below."""
STEADY = 0.1
"""Largest relative scatter of the length at the rests."""
CALM_BLOCKS = 40
"""Blocks of rows of which the calmer half are taken for rests."""
LONGEST_BLOCK = 50
SPANS = (10, 20, 40, 80)
"""Rows whose turn is looked at as one, 0.1 to 0.8 s at 100 Hz: longer ones average noise and shaking hands."""
LEAST_TURN, MOST_TURN = 0.005, 0.7
"""rad in a span: less is noise, more is not small."""
FEWEST_TURNS = 12
"""Spans with a turn from which a regression says anything."""
EXPLAINED = 0.8
"""Share of the turns' squares that the gyros explain, from which the regression holds."""
SHARE = 0.1
"""Share of the information on the most turned axis that another needs, for a factor of its own."""
UNIT_TOLERANCE = 0.3
"""Largest relative difference between the regression's factor and that of a unit; the next unit is 57 times another."""
RATE_UNITS = {"rad/s": 1.0, "°/s": np.pi / 180, "mdeg/s": np.pi / 180e3}
TIME_UNITS = {"s": 1.0, "ms": 1e3, "µs": 1e6, "ns": 1e9}
EPOCH = (1e8, 1e10)
"""s since 1970 of the years 1973 to 2286."""
LOGGED = (8.0, 8000.0)
"""Hz of logs of rests and turns by hand: three decades, so that one unit of time alone fits."""
ALIKE = 0.3
"""Largest step, as a share of the usual length, between rows that follow one another in a log."""


def at_rest(triad: Array) -> tuple[float, float]:
    """Usual length of a triad's readings (n, 3) at the calmer half of its rows, and its relative scatter there."""
    triad = triad[np.isfinite(triad).all(axis=1)]
    if len(triad) < 2:
        return 0.0, np.inf
    size = max(1, min(LONGEST_BLOCK, len(triad) // CALM_BLOCKS))
    blocks = triad[: len(triad) // size * size].reshape(-1, size, 3)
    spread = blocks.std(axis=1).sum(axis=1)
    lengths = np.linalg.norm(blocks.mean(axis=1)[spread <= np.median(spread)], axis=1)
    usual = float(np.median(lengths))
    return usual, float(np.median(np.abs(lengths - usual))) / usual if usual > 0 else np.inf


def gravity_at_rest(triad: Array) -> float | None:
    """Usual length of a triad's readings (n, 3) at rest; None where they differ in length."""
    usual, scatter = at_rest(triad)
    return usual if scatter <= STEADY else None


def is_like_gravity(length: float, gravity: float) -> bool:
    """Whether a length may be that of gravity."""
    return abs(length - gravity) <= LIKE_GRAVITY * gravity


def gravity_unit(length: float | None) -> str:
    """The unit in which gravity has this length; empty where none has."""
    return next((u for u, g in GRAVITIES.items() if length is not None and is_like_gravity(length, g)), "")


def follows_itself(triad: Array) -> bool:
    """Whether most rows (n, 3) are near the one before, as samples of a log are and positions are not."""
    steps, lengths = np.linalg.norm(np.diff(triad, axis=0), axis=1), np.linalg.norm(triad, axis=1)
    return len(triad) >= SAMPLES and bool(np.nanmedian(steps) <= ALIKE * np.nanmedian(lengths))


def clock_unit(time: Array) -> tuple[str, bool]:
    """The unit of times (n,) that none is stated of, and whether it is certain; empty where no unit fits."""
    step = usual_step(time)
    if len(time) < SAMPLES or step == 0:
        return "", False
    for unit, per_second in TIME_UNITS.items():
        if EPOCH[0] <= abs(time[0]) / per_second < EPOCH[1] and step / per_second < 1:
            return unit, True
    is_whole = bool(np.all(time == np.round(time)))
    if not is_whole and LOGGED[0] <= 1 / step < LOGGED[1] and time[0] < EPOCH[0]:
        return "s", True
    fitting = (u for u, per_second in TIME_UNITS.items() if LOGGED[0] <= per_second / step < LOGGED[1])
    return next(fitting, ""), False


def sample_rate(seconds: Array) -> float | None:
    """Rate of samples at these times (n,), Hz; two samples under one stamp both count. None of positions."""
    rate = rate_of(seconds)
    span, step = float(np.ptp(seconds)) if len(seconds) else 0.0, usual_step(seconds)
    if rate is not None or len(seconds) < SAMPLES or span <= 0:
        return rate
    mean = (len(seconds) - 1) / span
    return float(f"{mean:.3g}") if np.all(np.diff(seconds) >= 0) and mean > 1 and mean * step < SPANS[0] else None


@dataclass(frozen=True)
class TurnFactors:
    """Factors from readings of gyros to rad a row, by the turns of gravity."""

    factors: Array
    """(3,); of an axis that hardly turned the usual one."""
    explained: float
    """Share of the turns' squares that the gyros explain."""

    def unit(self, rate: float) -> str:
        """The unit of the readings at this rate; empty where it is none of the usual ones."""
        usual = float(np.median(np.abs(self.factors))) * rate
        near = (u for u, factor in RATE_UNITS.items() if abs(usual - factor) <= UNIT_TOLERANCE * factor)
        return next(near, "")


def turns_of(accelerometers: Array, gyros: Array) -> TurnFactors | None:
    """The regression of two triads (n, 3); None where there are too few turns, or the gyros do not explain them."""
    found = [turns for span in SPANS if (turns := _turns_over(accelerometers, gyros, span)) is not None]
    return max(found, key=lambda turns: turns.explained, default=None)


def _turns_over(accelerometers: Array, gyros: Array, span: int) -> TurnFactors | None:
    rows = len(accelerometers) // span * span
    felt = accelerometers[:rows].reshape(-1, span, 3).mean(axis=1)
    turned = gyros[:rows].reshape(-1, span, 3).mean(axis=1) * span
    lengths = np.linalg.norm(felt, axis=1)
    if not rows or not np.isfinite(felt).all() or not np.isfinite(turned).all() or lengths.min() == 0:
        return None
    u = felt / lengths[:, None]
    change = np.diff(u, axis=0)
    size = np.linalg.norm(change, axis=1)
    calm = size <= np.median(size)
    angle = (turned[1:] + turned[:-1]) / 2
    angle = angle - np.median(angle[calm], axis=0)
    near = np.abs(lengths / np.median(lengths) - 1) < LIKE_GRAVITY
    used = (size > LEAST_TURN) & (size < MOST_TURN) & near[1:] & near[:-1]
    if used.sum() < FEWEST_TURNS:
        return None
    middle, angle, change = ((u[1:] + u[:-1]) / 2)[used], angle[used], change[used]
    design = np.stack([-np.cross(np.eye(3)[k], middle) * angle[:, k, None] for k in range(3)], axis=-1)
    return _regressed(design.reshape(-1, 3), change.ravel())


def _regressed(design: Array, change: Array) -> TurnFactors | None:
    information = np.einsum("ij,ij->j", design, design)
    seen = information > SHARE * information.max()
    if not information.max() > 0:
        return None
    known, *_ = np.linalg.lstsq(design[:, seen], change, rcond=None)
    residual = change - design[:, seen] @ known
    explained = 1 - float(residual @ residual) / float(change @ change)
    factors = np.full(3, np.median(known))
    factors[seen] = known
    return TurnFactors(factors, explained) if explained >= EXPLAINED else None
