"""Courses without a formula: how alike rows are that lie near one another in some order.

A course is a Gaussian process of a covariance over the rows: a walk, one that jumps from level to level (of
Ornstein and Uhlenbeck), one that bends (Matérn 3/2), one of alternating sign (Rasmussen & Williams 2006, 4.2), or a
wave of so many periods, of unknown size and phase.
"""

from collections.abc import Iterator

import numpy as np

from estimator.arrays import eigh
from estimator.causes.contract import Setting, varies
from estimator.message import say
from estimator.session import Array

FEWEST = 6
"""Different temperatures from which on a course over temperature is more than a line."""

TOGETHER = {"the order measured": "β and the order measured", "temperature": "β and temperature"}
"""Orders along which a course may run together with β."""

USUAL = {
    "the order measured": 0.4,
    "temperature": 0.2,
    "β": 0.1,
    "the sensor's input": 0.1,
    "β, each run separately": 0.1,
    "β and the order measured": 0.05,
    "β and temperature": 0.05,
    "the vibration": 0.1,
}
"""Prior share of the orders, in proportion: what wanders, wanders in time. Those that a session lacks have none."""

ROUND = (0.4, 1.0)
"""Length, rad, over which a course around β keeps its value: some six harmonics, or two."""

LENGTHS = (0.08, 0.25)
"""Share of the order's range over which a bending course keeps its value: shorter ones look like noise over some
dozen rows, longer ones like the baseline's own terms."""

LEVEL = 0.15
"""Share of the order's range over which a course that jumps keeps its level: half a dozen levels."""

HIGHEST = 8
"""Harmonic of β up to which a wave is looked for: beyond it an angle's error is no longer that of a bearing."""

FEWEST_PERIODS = 1.5
"""Periods from which on a course is a wave rather than a curve, which a smooth kernel describes."""

EVEN = 0.1
"""Share of a row's step by which rows may come early or late and still count as even: a wave of half as many periods
as rows is then off by a twentieth of its own period."""

FAINT = 1e-4
"""Share of a kernel's largest direction below which one counts as none."""


def common_orders(setting: Setting) -> dict[str, Array]:
    """Orders along which every sensor's zero may run: (R,) places, relative, 0 … 1."""
    keys = {"the order measured": np.arange(setting.rows, dtype=float)}
    if setting.temperature is not None and len(np.unique(setting.temperature)) >= FEWEST:
        keys["temperature"] = setting.temperature
    if setting.beta is not None:
        keys["β"] = np.mod(setting.beta, 2 * np.pi)
    return relative(keys)


def own_orders(setting: Setting, sensor: int) -> dict[str, Array]:
    """Further orders of one sensor: (R,) places, relative, 0 … 1."""
    keys = {"the sensor's input": setting.a[:, sensor]}
    if setting.vibration is not None and varies(setting.vibration[:, [sensor]]):
        keys["the vibration"] = np.sqrt(setting.vibration[:, sensor])
    return relative(keys)


def relative(keys: dict[str, Array]) -> dict[str, Array]:
    """Places from 0 to 1 along every key (R,) that varies."""
    return {name: (key - key.min()) / np.ptp(key) for name, key in keys.items() if np.ptp(key) > 0}


def common_kernels(setting: Setting) -> Iterator[tuple[str, Array]]:
    """Covariances (R, R), dimensionless, of courses along the orders that sensors have in common; where there is a
    stand, also around β together with another order, as whatever depends on both is smooth in both."""
    places = common_orders(setting)
    yield from along_each(places)
    if setting.beta is None or setting.flipped is None:
        return
    turning = [around(setting.beta, length) for length in ROUND]
    same_run = setting.flipped[:, None] == setting.flipped
    if not same_run.all():
        yield from (("β, each run separately", kernel * same_run) for kernel in turning)
    for name, both in TOGETHER.items():
        if name in places:
            yield from ((both, bending(places[name], LENGTHS[-1]) * kernel) for kernel in turning)


def along_each(places: dict[str, Array]) -> Iterator[tuple[str, Array]]:
    """Orders with the covariances of courses along each of them."""
    yield from ((name, kernel) for name, place in places.items() for kernel in along(place))


def along(place: Array) -> Iterator[Array]:
    """(R, R) dimensionless covariances of courses along places (R,) in 0 … 1."""
    distance = np.abs(place[:, None] - place)
    yield np.minimum(place[:, None], place)
    yield np.exp(-distance / LEVEL)
    yield from (bending(place, length) for length in LENGTHS)
    sign = (-1.0) ** np.argsort(np.argsort(place, kind="stable"), kind="stable")
    yield bending(place, LENGTHS[-1]) * np.outer(sign, sign)


def bending(place: Array, length: float) -> Array:
    """(R, R) dimensionless covariance of a course along places (R,) that keeps its value over a length (Matérn 3/2)."""
    distance = np.sqrt(3) * np.abs(place[:, None] - place) / length
    return np.asarray((1 + distance) * np.exp(-distance))


def around(beta: Array, length: float) -> Array:
    """(R, R) dimensionless covariance of a course around β (R,), rad, that keeps its value over a length, rad (MacKay
    1998, periodic)."""
    return np.asarray(np.exp(-2 * (np.sin((beta[:, None] - beta) / 2) / length) ** 2))


def root(kernel: Array) -> Array:
    """L (R, r) with LL' a covariance (R, R) of mean variance one."""
    size, turn = eigh(kernel * len(kernel) / max(float(np.trace(kernel)), 1e-300))
    keep = size > FAINT * size[-1]
    return np.asarray(turn[:, keep] * np.sqrt(size[keep]))


def common_waves(setting: Setting) -> Iterator[tuple[str, Array]]:
    """Orders that sensors have in common, and sine and cosine (R, 2) along them of every number of periods that the
    rows resolve; around β its harmonics."""
    for order, place in common_orders(setting).items():
        by_time = clock(setting) if order == "the order measured" else None
        if order == "β":
            yield from harmonics(setting)
        else:
            yield from waves({order: place})
        if by_time is not None:
            yield from waves({order: by_time})


def waves(places: dict[str, Array]) -> Iterator[tuple[str, Array]]:
    """Orders, and waves (R, 2) along each of every number of periods that its places resolve; fewer periods than
    `FEWEST_PERIODS` are courses of a kernel."""
    for order, place in places.items():
        periods = np.arange(2 * FEWEST_PERIODS, len(np.unique(np.round(place, 9))) + 1) / 2
        yield from ((order, wave(2 * np.pi * k * place)) for k in periods)


def harmonics(setting: Setting) -> Iterator[tuple[str, Array]]:
    """Harmonics of β, in words and as (R, 2), from the second on, alike in both runs or opposite."""
    assert setting.beta is not None
    assert setting.flipped is not None
    opposite = np.where(setting.flipped, -1.0, 1.0)[:, None]
    both = 0 < setting.flipped.sum() < setting.rows
    for k in range(2, HIGHEST + 1):
        words, columns = say("harmonic {shape} of β", shape=k), wave(setting.beta * k)
        yield words, columns
        if both:
            yield words, columns * opposite


def clock(setting: Setting) -> Array | None:
    """(R,) relative place of every row by time; None where that is its place by count."""
    if setting.time is None or not np.ptp(setting.time) > 0:
        return None
    elapsed = (setting.time - setting.time[0]) / np.ptp(setting.time)
    count = np.arange(setting.rows) / max(setting.rows - 1, 1)
    return elapsed if np.abs(elapsed - count).max() > EVEN / setting.rows else None


def wave(angle: Array) -> Array:
    """(R, 2) sine and cosine of angles (R,), of mean variance one."""
    return np.sqrt(2) * np.stack([np.sin(angle), np.cos(angle)], axis=-1)
