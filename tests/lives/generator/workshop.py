"""Times and places of measurements of a unit: dates with gaps, halls with winters, stands with shifts of their own."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from tests.lives.generator.kinds import DAYS, YEAR, Array, Random

STANDS = 5
SET_POINT = 20.0
"""°C of a hall that is kept warm."""
ARCSEC = np.pi / 648_000


@dataclass(frozen=True, eq=False)
class Stand:
    """One stand with its hall."""

    name: str
    seating: float
    """rad, one sigma a direction, of how a block sits anew at every session."""
    shift_days: Array
    """(s,) days since the first of all sessions at which the stand was shifted."""
    shifts: Array
    """(s, 3) rad, rotation vectors in block axes, each from its day on."""
    air: Array
    """(days,) °C of the hall."""

    def turned(self, day: float) -> Array:
        """(3,) rad by which the stand has been shifted by a day."""
        return np.asarray(self.shifts[self.shift_days <= day].sum(axis=0))


def draw_stands(rng: Random) -> tuple[Stand, ...]:
    """Five stands; two of the halls are cold in winter, about two stands are shifted some day."""
    return tuple(_stand(f"ST-{i + 1}", rng, is_cold=i >= STANDS - 2) for i in range(STANDS))


def _stand(name: str, rng: Random, *, is_cold: bool) -> Stand:
    shifts = int(rng.random() < 0.4)
    return Stand(
        name=name,
        seating=float(rng.choice([1.0, 3.0, 8.0])) * ARCSEC,
        shift_days=np.sort(rng.integers(200, 1600, shifts)).astype(float),
        shifts=rng.choice([-1.0, 1.0], (shifts, 3)) * rng.uniform(5, 25, (shifts, 3)) * ARCSEC,
        air=hall(rng, is_cold=is_cold),
    )


def hall(rng: Random, *, is_cold: bool) -> Array:
    """(days,) °C: near the set point, or following the year's weather by a share; fronts last some days."""
    fronts = lfilter([1.0], [1.0, -0.8], rng.standard_normal(len(DAYS)))
    coldest = rng.uniform(0, YEAR)
    outside = 8 - 13 * np.cos(2 * np.pi * (DAYS - coldest) / YEAR) + 2 * fronts
    if not is_cold:
        return SET_POINT + 0.3 * fronts
    return SET_POINT - rng.uniform(0.3, 0.7) * np.maximum(SET_POINT - outside, 0.0) * 0.9 + 0.4 * fronts


def session_days(years: float, rng: Random) -> Array:
    """(n,) whole days since the first: every four to twelve months, kept badly; gaps, repeats in a week."""
    period, days, day = rng.choice([0.33, 0.5, 0.5, 1.0]) * YEAR, [0], 0
    while True:
        wait = period * (1 + 0.25 * abs(rng.standard_normal()) - 0.1)
        if rng.random() < 0.08:
            wait += YEAR * rng.uniform(0.5, 1.5)
        if rng.random() < 0.12:
            wait = rng.uniform(1, 10)
        day += max(round(wait), 1)
        if day > years * YEAR:
            return np.array(days)
        days.append(day)
