"""Readings of a raw log that are none: markers, lost signs, empty and repeated vectors, channels that stand still.

Every test is by the readings' neighbours, in the file's own numbers, and knows no physical range. Equal neighbours mean
nothing by themselves: a quiet sensor of coarse steps repeats its value, and several of them their vector, as often as
their steps make it likely; only what chance does not explain is left out.
"""

import numpy as np
from numpy.typing import NDArray

from estimator.session import Array

Mask = NDArray[np.bool_]
Rows = NDArray[np.intp]

BITS = (8, 16, 24, 32)
"""Bits of the words in which sensors write their readings."""
MARKERS = np.array(
    [sign * (2.0**bits - less) for bits in (7, 15, 23, 31) for sign, less in ((-1, 0), (1, 1))]
    + [2.0**bits - 1 for bits in (16, 24, 32)]
    + [sign * value for value in (999, 9999, 99999, 999999, 999.9, 9999.9, 999.99) for sign in (-1.0, 1.0)]
)
"""Values that sources write for no data: the ends of a word, and rows of nines. Zero is judged by whole vectors."""
LARGEST = 1e20
"""Reading beyond the counts of any instrument (`reading.bounds`): 1e30 and its like stand for none."""
APART = 10.0
"""Times the local steps by which a marker leaps away from its neighbours on both sides: a turn that reaches the end of
its range comes nearer step by step."""
AGAIN = 3
"""Samples of one extreme value, each far from its neighbours, that are no chance: continuous noise has none twice."""
LONG = 20
"""Samples at exactly one value that noise of several steps cannot give: a chance of a third, twenty times over."""
LONGER = 10.0
"""Times the usual length of runs: the longest of a million, where a quiet sensor repeats its value by chance."""
SOME = 3
"""Longest runs that do not count for the usual one: a channel freezes rarely, a quiet sensor all the time."""
BY_CHANCE = 5.0
"""Times the share of equal vectors that independent channels give: coupled by rests alone they give up to 3.4 (each of
three coarse channels unchanged in two of three changes of the vector)."""
OFTEN = 0.2
"""Share of repeated vectors from which a logger is faster than its sensor: it takes every reading more than once."""
ON_STEP = 0.05
"""Largest mean distance of readings from multiples of a step, as a part of it; a quarter for readings without steps."""
LOOKED_AT = 4096
"""Samples, evenly chosen, from which a typical step is taken: known to 2 %."""


def usual_step(x: Array) -> float:
    """Median change, other than 0, between neighbours of x (R,), in its unit; 0 where it never changes."""
    every = max(len(x) // LOOKED_AT, 1)
    steps = np.abs(x[1::every] - x[:-1:every])
    steps = steps[steps > 0]
    return float(np.median(steps)) if len(steps) else 0.0


def without_sign(x: Array) -> int | None:
    """Bits of the word that x (R,) was read from without its sign; None where its jumps do not show that."""
    if not len(x) or x.min() < 0:
        return None
    bits = next((n for n in BITS if x.max() < 2.0**n), None)
    if bits is None or x.max() < 2.0 ** (bits - 1) or not is_whole(x):
        return None
    half, before, after = 2.0 ** (bits - 1), np.abs(np.diff(x)), np.abs(np.diff(signed(x, bits)))
    jumps = before > half
    if not jumps.any() or not (~jumps).any():
        return None
    most = max(float(np.quantile(before[~jumps], 0.999)), 1.0)
    return bits if np.median(after[jumps]) <= AGAIN * most else None


def unit_of(x: Array) -> float:
    """The step of whose multiples x (R,) consists, in its unit; 1 of counts and of what consists of none.

    From small multiples on to larger ones: each tells the step so much better that the next are told apart.
    """
    values = np.unique(x[:LOOKED_AT])
    unit, span = smallest_step(x), float(np.ptp(values)) if len(values) else 0.0
    if is_whole(x) or unit <= 0 or len(values) < LONG or span > 2.0 ** BITS[-1] * unit:
        return 1.0
    apart = np.concatenate([np.diff(values), values - values[0]])
    for reach in 10.0 ** np.arange(1, 2 + np.ceil(np.log10(span / unit))):
        near = apart[(apart > 0) & (apart <= reach * unit)]
        places = np.round(near / unit)
        unit = float((near @ places) / (places @ places))
        if np.abs(near / unit - np.round(near / unit)).mean() > ON_STEP:
            return 1.0
    return unit


def is_whole(x: Array) -> bool:
    """Whether x (R,) are counts."""
    return bool((x[:LOOKED_AT] == np.floor(x[:LOOKED_AT])).all())


def signed(x: Array, bits: int) -> Array:
    """Words x (R,) of so many bits with their sign."""
    return np.where(x >= 2.0 ** (bits - 1), x - 2.0**bits, x)


def may_be_unsigned(x: Array, bits: int) -> bool:
    """Whether x (R,) are words without a sign, of which some had one."""
    return bool(len(x) and x.min() >= 0 and 2.0 ** (bits - 1) <= x.max() < 2.0**bits and is_whole(x))


def is_just_below_zero(x: Array) -> int | None:
    """Bits of words x (R,) that all lie within a tenth of half their range below 0, read without a sign."""
    if not len(x) or x.min() < 0 or not is_whole(x):
        return None
    return next((n for n in BITS[1:] if x.min() >= 0.95 * 2.0**n and x.max() < 2.0**n), None)


def markers(x: Array) -> list[tuple[float, Rows]]:
    """Values that stand for no data in finite x (R,), with their rows: single, or in runs, far from what is around."""
    step, found = usual_step(x), []
    free = np.ones(len(x), dtype=bool)
    if step == 0 or len(x) < 2 * AGAIN:
        return []
    for _ in range(AGAIN):
        values = _candidates(x, free, step)
        new = [(value, _leaping(x, free, value, values, step)) for value in values]
        new = [(value, rows) for value, rows in new if len(rows)]
        if not new:
            break
        found += new
        for _, rows in new:
            free[rows] = False
    return found


def _candidates(x: Array, free: Mask, step: float) -> list[float]:
    """Known markers, and extremes and the most frequent that come again, among the values that x leaps to."""
    y = x[free]
    if len(y) < 2:
        return []
    leaps = np.append(True, np.abs(np.diff(y)) > APART * step)
    landed, count = np.unique(y[leaps], return_counts=True)
    known = np.isin(landed, MARKERS)
    ends = np.isin(landed, (y.min(), y.max())) | (np.arange(len(landed)) == count.argmax())
    return list(map(float, landed[known | (ends & (count >= AGAIN))]))


def _leaping(x: Array, free: Mask, value: float, values: list[float], step: float) -> Rows:
    """Rows of one of the ``values`` that x leaps to and back from, further than the others move around them; none where
    that is chance."""
    others = np.flatnonzero(free & ~np.isin(x, values))
    rows = np.flatnonzero(free & (x == value))
    if len(others) < 2 or not len(rows):
        return rows[:0]
    y = x[others]
    moves = np.pad(np.abs(np.diff(y)), 1, mode="edge")
    after = np.searchsorted(others, rows)
    low, high = np.clip(after - 1, 0, len(y) - 1), np.clip(after, 0, len(y) - 1)
    around = np.max([moves[low], moves[high], moves[np.clip(after + 1, 0, len(y))]], axis=0)
    leap = np.minimum(np.abs(value - y[low]), np.abs(value - y[high]))
    found = rows[leap > APART * np.maximum(around, step)]
    if 2 * len(found) > len(rows) and (value > y.max() or value < y.min()):
        return rows  # the end of the range: at it nothing is told within a turn either
    return found if len(found) >= (1 if value in MARKERS else AGAIN) else rows[:0]


def longest_run(rows: Rows) -> int:
    """Most of increasing ``rows`` (n,) that follow one another."""
    runs = np.split(rows, np.flatnonzero(np.diff(rows) != 1) + 1)
    return max(map(len, runs), default=0)


def zero_vectors(x: Array, *, weighed: bool) -> Mask:
    """(R,) vectors of x (R, c) that are exactly 0 between others and hold no reading; ``weighed``: gravity shows in
    every one that does, however long they are."""
    none = np.zeros(len(x), dtype=bool)
    zero = x == 0
    empty = zero.all(axis=1)
    if x.shape[1] < 2 or not empty.any() or empty.all():
        return none
    size = np.abs(x[~empty]).max(axis=1)
    calm = size <= np.quantile(size, OFTEN)
    chance = float(np.prod(zero[~empty][calm].mean(axis=0))) * len(x)
    if empty.sum() <= 2 * BY_CHANCE * chance + AGAIN:
        return none
    edge = np.flatnonzero(np.diff(empty.astype(np.int8)))
    beside = np.abs(x[np.where(empty[edge], edge + 1, edge)])
    fine = np.array([smallest_step(channel) for channel in x.T])
    lengths = np.diff(np.flatnonzero(np.append(np.diff(empty.astype(np.int8), prepend=0), -1 if empty[-1] else 0)))[::2]
    is_between = weighed or np.median(lengths) <= BY_CHANCE
    return empty if is_between and np.mean((beside > AGAIN * fine).any(axis=1)) > 0.5 else none


def smallest_step(x: Array) -> float:
    """Least distance between different values of finite x (R,), in its unit, of some of them; 0 where all are one."""
    values = np.unique(x[:LOOKED_AT])
    return float(np.diff(values).min()) if len(values) > 1 else 0.0


def frozen(x: Array) -> Mask:
    """(R,) samples of finite x (R,) that only repeat one value for long, where the channel scatters elsewhere."""
    result = np.zeros(len(x), dtype=bool)
    if len(x) < 2 * LONG or not (x[LONG - 1 :] == x[: 1 - LONG]).any():
        return result
    change = np.flatnonzero(x[1:] != x[:-1]) + 1
    if not len(change):
        return result
    start = np.concatenate([[0], change])
    length = np.diff(np.append(start, len(x)))
    if length.max() < LONG:
        return result
    ordered = np.sort(length)[: -SOME or None]
    share = np.cumsum(ordered)
    usual = ordered[np.searchsorted(share, 0.95 * share[-1])] if len(share) else len(x)
    long = np.flatnonzero(length >= max(LONG, LONGER * usual))
    values = x[start[long]]
    near = np.abs(values[:, None] - values) <= smallest_step(x)
    for k in long[near.sum(axis=1) == 1]:
        result[start[k] + 1 : start[k] + length[k]] = True
    return result


def repeated(x: Array) -> Mask:
    """(R,) vectors of finite x (R, c) that only repeat the one before, by a logger faster than the sensors."""
    none = np.zeros(len(x), dtype=bool)
    if len(x) < 2 * LONG:
        return none
    equal = np.diff(x, axis=0) == 0
    same = equal.all(axis=1)
    share = float(same.mean())
    if share < OFTEN or share == 1:
        return none
    chance = float(np.prod(equal[~same].mean(axis=0)))
    step = np.array([usual_step(channel) / (smallest_step(channel) or np.inf) for channel in x.T])
    if share < BY_CHANCE * chance or (step < AGAIN + 1).all():
        return none
    size = np.abs(np.diff(x, axis=0)).max(axis=1)
    large = np.flatnonzero(~same[:-1] & (size[:-1] >= np.quantile(size[~same], 0.9)))
    return np.append(False, same) if len(large) and same[large + 1].mean() > 0.5 * share else none


def share_of_equal(x: Array) -> float:
    """Share of equal neighbours in x (R,)."""
    return float(np.count_nonzero(x[1:] == x[:-1])) / max(len(x) - 1, 1)


def at_end(x: Array, value: float) -> Mask:
    """(R,) bool: finite x (R,) stands at an extreme ``value`` that it runs into again and again."""
    stood = x == value
    edge = np.flatnonzero(stood[1:] != stood[:-1])
    beside = np.abs(x[np.where(stood[edge], edge + 1, edge)] - value)
    is_met = len(edge) > AGAIN and 2 * np.count_nonzero(stood) >= AGAIN * len(edge)
    return stood if is_met and np.median(beside) > APART * smallest_step(x) else np.zeros(len(x), dtype=bool)
