"""Logs of a block turned by hand from rest to rest: accelerometers and gyros, as people's loggers write them."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
GRAVITY = 9.80665
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Hands:
    """A log of n samples in SI."""

    rate: float
    time: Array
    """(n,) s."""
    force: Array
    """(n, 3) specific force, m/s²."""
    turning: Array
    """(n, 3) angular rate, rad/s."""


def by_hand(seed: int = 1, rests: int = 14, rate: float = 100.0) -> Hands:
    """Rests of 1.2 s with turns of 0.8 s about random axes between them; noise and biases of a cheap block."""
    rng = np.random.default_rng(seed)
    still, moving = round(1.2 * rate), round(0.8 * rate)
    pace = 1 - np.cos(2 * np.pi * (np.arange(moving) + 0.5) / moving)
    turning = []
    for _ in range(rests):
        axis = rng.standard_normal(3)
        rate_of_turn = pace * rng.uniform(0.8, 2.0) / 0.8
        turning += [np.zeros((still, 3)), rate_of_turn[:, None] * axis / np.linalg.norm(axis)]
    rates = np.vstack(turning)
    attitude, felt = Rotation.random(random_state=seed), []
    for step in rates / rate:
        felt.append(attitude.inv().apply(UP))
        attitude = attitude * Rotation.from_rotvec(step)
    force = GRAVITY * np.array(felt) + rng.normal(0, 0.02, rates.shape) + [0.1, -0.05, 0.08]
    measured = rates + rng.normal(0, 0.002, rates.shape) + [0.01, -0.008, 0.004]
    return Hands(rate, np.arange(len(rates)) / rate, force, measured)


Clock = Callable[[float], str]


def moments(form: str, start: datetime = datetime(2026, 3, 1, 9, 59, 50)) -> Clock:
    """Times of day as a logger writes them, milliseconds last."""
    return lambda t: (start + timedelta(seconds=t)).strftime(form)[:-3]


def counted(per_second: float, start: int = 0) -> Clock:
    """Whole ticks from a start on."""
    return lambda t: str(start + round(t * per_second))


def seconds(t: float) -> str:
    """Seconds with four digits."""
    return f"{t:.4f}"


def written(
    columns: Sequence[tuple[str, Iterable[str]]], separator: str = ",", decimal: str = ".", above: str = ""
) -> bytes:
    """A text of columns with their headings."""
    rows = zip(*([heading, *cells] for heading, cells in columns), strict=True)
    return (above + "\n".join(separator.join(row) for row in rows)).replace("\\decimal", decimal).encode()


def numbers(values: Array, form: str = ".6g") -> list[str]:
    """Cells of a column, its decimal sign yet to be chosen."""
    return [format(value, form).replace(".", "\\decimal") for value in values]


def triad(headings: Sequence[str], values: Array, form: str = ".6g") -> list[tuple[str, list[str]]]:
    """Three columns."""
    return [(heading, numbers(values[:, k], form)) for k, heading in enumerate(headings)]


def xyz(form: str, axes: str = "XYZ") -> list[str]:
    """``form`` with each axis for its star."""
    return [form.replace("*", axis) for axis in axes]
