"""A recording as means of blocks, in bounded memory: however long it is, no more than `MOST` blocks are kept.

A block begins as `BLOCK` seconds of samples. When there are too many, neighbours are joined two by two and the blocks
are twice as long from then on. A block keeps the mean of each sensor's input, how much the inputs moved within it, the
extreme readings, by which a channel that ran into its end is known, and what lever arms, delays and vibration do to a
mean: the moments of the angular rate, the change of the vector from end to end, its covariance. For the course in time
it keeps by sensor the means of its quarters, how often a reading stood still, and how parity and what the others say of
it change from sample to sample.
"""

import copy
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from estimator.parity.motion import Gyros
from estimator.parity.reference import ParityReference
from estimator.session import Array

BLOCK = 1.0
"""s of samples that make the first blocks: vibration averages out, a manoeuvre does not."""

MOST = 4096
"""Blocks kept at most, an hour of seconds; even, so that they can be joined two by two."""

RAIL_SAMPLES = 10
"""Samples at one extreme reading from which it may be the end of the converter's range."""

RAIL_PEAK = 5
"""Least ratio of samples at the end of a range to those at the next reading; the tail of noise falls more gently."""


@dataclass(frozen=True, eq=False)
class Blocks:
    """B blocks in the order measured. m sensors."""

    first: NDArray[np.int64]
    """(B,) place of the block, in blocks since the start; a gap is a block that was left out."""
    samples: Array
    """(B,) number of samples in each."""
    mean: Array
    """(B, m) mean of the inputs, m/s² (rad/s)."""
    quarters: Array
    """(B, m, 4) means of its quarters less its mean, m/s² (rad/s)."""
    motion: Array
    """(B, m) variance of the inputs within the block, (m/s²)² ((rad/s)²); 0 for averages."""
    jitter: Array
    """(B, m) variance within the block from the differences of neighbouring samples, (m/s²)² ((rad/s)²): noise shows in
    it, slow motion does not.
    """
    flutter: Array
    """(B, m) variance of V·p from the differences of neighbouring samples, (m/s²)² ((rad/s)²): motion shows little in
    it.
    """
    standing: Array
    """(B, m) share of the samples that read what the one before reads."""
    change: Array
    """(B, m) mean square of the change of what the others say of a sensor, (m/s²)² ((rad/s)²) a sample²."""
    lowest: Array
    """(B, m) smallest reading, reading units."""
    highest: Array
    """(B, m) largest reading, reading units."""
    parity_variance: Array
    """(B,) variance within the block of the parity vector's elements: noise alone, (m/s²)² ((rad/s)²)."""
    gain: Array
    """(B, 3) change of the vector from the sample before the block to its last, m/s² (rad/s)."""
    shake: Array
    """(B, 6) covariance of the vector within the first blocks, as `pairs`, (m/s²)² ((rad/s)²)."""
    spin: Array
    """(B, 3) mean angular rate, rad/s; (B, 0) where no gyros run beside, as the next two."""
    spin_gain: Array
    """(B, 3) change of the angular rate from the sample before the block to its last, rad/s."""
    spin_square: Array
    """(B, 6) mean of its products, as `pairs`, (rad/s)²."""

    def __len__(self) -> int:
        return len(self.first)

    @property
    def halves(self) -> Array:
        """(B, m) half of what the mean of the block's second half differs from that of its first, m/s² (rad/s)."""
        return np.asarray(self.quarters @ HALVES)

    def at(self, chosen: Array) -> "Blocks":
        """Some of the blocks: by number (n,), or by bool (B,)."""
        return Blocks(*(column[chosen] for column in vars(self).values()))

    def of(self, sensors: Array) -> "Blocks":
        """Some of the sensors, by number (n,)."""
        return replace(self, **{name: getattr(self, name)[:, sensors] for name in BY_SENSOR})

    def joined(self) -> "Blocks":
        """Neighbours two by two; the number of blocks must be even."""
        left, right = (vars(self.at(np.arange(k, len(self), 2))) for k in (0, 1))
        samples = left["samples"] + right["samples"]
        share = right["samples"] / samples

        def mean(name: str) -> Array:
            """Mean over both halves, weighed by their samples."""
            weight = share.reshape(-1, *[1] * (left[name].ndim - 1))
            return np.asarray((1.0 - weight) * left[name] + weight * right[name])

        return Blocks(
            first=left["first"] // 2,
            samples=samples,
            mean=mean("mean"),
            quarters=np.concatenate([_paired(part) - mean("mean")[:, :, None] for part in (left, right)], axis=2),
            motion=np.maximum(left["motion"], right["motion"]),
            jitter=np.maximum(left["jitter"], right["jitter"]),
            flutter=mean("flutter"),
            standing=mean("standing"),
            change=mean("change"),
            lowest=np.minimum(left["lowest"], right["lowest"]),
            highest=np.maximum(left["highest"], right["highest"]),
            parity_variance=mean("parity_variance"),
            gain=left["gain"] + right["gain"],
            shake=mean("shake"),
            spin=mean("spin"),
            spin_gain=left["spin_gain"] + right["spin_gain"],
            spin_square=mean("spin_square"),
        )


BY_SENSOR = ("mean", "quarters", "motion", "jitter", "flutter", "standing", "change", "lowest", "highest")
"""Columns of blocks whose second axis is the sensors."""
HALVES = np.array([-0.25, -0.25, 0.25, 0.25])


def _paired(part: dict[str, Array]) -> Array:
    """(B, m, 2) means of the halves of blocks."""
    return np.asarray(part["mean"][:, :, None] + 0.5 * (part["quarters"][:, :, ::2] + part["quarters"][:, :, 1::2]))


def quarters_of(a: Array) -> Array:
    """(B, m, 4) means of the quarters of blocks (B, length, m) less their mean; a short block's share samples."""
    length = a.shape[1]
    edges = [k * length // 4 for k in range(5)]
    means = [a[:, first : max(last, first + 1)].mean(axis=1) for first, last in pairwise(edges)]
    return np.asarray(np.stack(means, axis=2) - a.mean(axis=1)[:, :, None])


def pairs(vectors: Array) -> Array:
    """(..., 6) products xx, yy, zz, xy, xz, yz of vectors (..., 3), in their unit squared."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    return np.stack([x * x, y * y, z * z, x * y, x * z, y * z], axis=-1)


def empty_blocks(m: int, count: int) -> Blocks:
    """Blocks of m sensors that hold zeros; one after the other, of one sample each."""
    width = dict.fromkeys(BY_SENSOR, m) | {"gain": 3, "shake": 6, "spin": 3, "spin_gain": 3, "spin_square": 6}
    zeros = {name: np.zeros((count, n)) for name, n in width.items()} | {"quarters": np.zeros((count, m, 4))}
    return Blocks(first=np.arange(count), samples=np.ones(count), parity_variance=np.zeros(count), **zeros)


class Rails:
    """The two outermost readings of each channel at one end, and how often each stood there."""

    def __init__(self, sign: float, m: int) -> None:
        """``sign`` is 1 for the upper end, −1 for the lower; m channels."""
        self.sign = sign
        self.value = np.full((2, m), -np.inf)
        self.count = np.zeros((2, m), dtype=np.int64)

    def add(self, readings: Array) -> None:
        """Count samples (R, m) in, reading units."""
        u = self.sign * readings
        top = u.max(axis=0)
        second = np.where(u < top, u, -np.inf).max(axis=0)
        for value in (top, second):
            self._merge(value, (u == value).sum(axis=0))

    def _merge(self, value: Array, count: NDArray[np.int64]) -> None:
        """A reading of each channel (m,), reading units, that stood ``count`` (m,) times."""
        for place in (0, 1):
            same = self.value[place] == value
            self.count[place] += np.where(same, count, 0)
            value = np.where(same, -np.inf, value)
            larger = value > self.value[place]
            stored, times = self.value[place].copy(), self.count[place].copy()
            self.value[place], self.count[place] = np.where(larger, value, stored), np.where(larger, count, times)
            value, count = np.where(larger, stored, value), np.where(larger, times, count)

    def of(self, channels: Array) -> "Rails":
        """Some of the channels, by number (n,)."""
        some = Rails(self.sign, len(channels))
        some.value, some.count = self.value[:, channels], self.count[:, channels]
        return some

    @property
    def limit(self) -> Array:
        """(m,) the reading at which a channel is cut off, reading units; NaN where none is seen."""
        cut = (self.count[0] >= RAIL_SAMPLES) & (self.count[0] > RAIL_PEAK * self.count[1])
        return np.where(cut, self.sign * self.value[0], np.nan)

    @property
    def clipped(self) -> NDArray[np.int64]:
        """(m,) samples in which a channel stood where it is cut off."""
        return np.where(np.isnan(self.limit), 0, self.count[0])


class Ledger:
    """Takes samples as they come and keeps blocks."""

    def __init__(self, reference: ParityReference, length: int, most: int = MOST, gyros: Gyros | None = None) -> None:
        """``length`` is the number of samples of a block; 1 for rows that are averages."""
        self.reference = reference
        self.gyros = gyros
        self.length = length
        self.averaged = length == 1
        self._most = most
        self._waiting: list[Array] = []
        self._kept: list[Blocks] = []
        self._count = 0
        self._before: tuple[Array, Array] | None = None
        self.samples = 0
        self.quantum = np.full(len(reference.names), np.inf)
        """(m,) smallest change of a reading, reading units."""
        self.ends = (Rails(1.0, len(reference.names)), Rails(-1.0, len(reference.names)))

    def add(self, readings: Array) -> None:
        """The next samples (R, m) of all m sensors of the recording, reading units, in the order measured."""
        self._waiting.append(np.asarray(readings, dtype=float))
        waiting = np.concatenate(self._waiting)
        whole = len(waiting) // self.length * self.length
        self._waiting = [waiting[whole:].copy()]
        step = self.length * max(self._most // 4, 1)
        for start in range(0, whole, step):
            self._take(waiting[start : min(start + step, whole)])

    def _take(self, readings: Array) -> None:
        """Whole blocks of samples (R, m), reading units, few enough to fit."""
        length = self.length
        chunks = readings.reshape(-1, length, readings.shape[1])
        u = readings[:, self.reference.column]
        for end in self.ends:
            end.add(u)
        self.samples += len(readings)
        inputs = self.reference.inputs(readings)
        a = inputs.reshape(len(chunks), length, -1)
        p = (inputs @ self.reference.parity).reshape(len(chunks), length, -1)
        n = self.reference.vector(inputs).reshape(len(chunks), length, 3)
        rate = np.empty((len(readings), 0)) if self.gyros is None else self.gyros.rates(readings)
        rate = rate.reshape(len(chunks), length, -1)
        gain, spin_gain = self._gains(n, rate)
        chunked = u.reshape(len(chunks), length, -1)
        steps = np.abs(np.diff(chunked, axis=1))
        if length > 1:
            self.quantum = np.minimum(self.quantum, np.where(steps > 0, steps, np.inf).min(axis=(0, 1)))
        shown = p @ self.reference.parity.T
        others = np.diff(self.reference.others(inputs).reshape(a.shape), axis=1)
        between = max(length - 1, 1)
        self._kept.append(
            Blocks(
                first=self._count + np.arange(len(chunks)),
                samples=np.full(len(chunks), float(length)),
                mean=a.mean(axis=1),
                quarters=quarters_of(a),
                motion=a.var(axis=1),
                jitter=0.5 * (np.diff(a, axis=1) ** 2).sum(axis=1) / between,
                flutter=0.5 * (np.diff(shown, axis=1) ** 2).sum(axis=1) / between,
                standing=(steps == 0).sum(axis=1) / between,
                change=(others**2).sum(axis=1) / between,
                lowest=chunked.min(axis=1),
                highest=chunked.max(axis=1),
                parity_variance=p.var(axis=1).mean(axis=1),
                gain=gain,
                shake=pairs(n - n.mean(axis=1, keepdims=True)).mean(axis=1),
                spin=rate.mean(axis=1),
                spin_gain=spin_gain,
                spin_square=pairs(rate).mean(axis=1) if rate.shape[2] else rate.mean(axis=1),
            )
        )
        self._count += len(chunks)
        if self._count > self._most:
            self._halve()

    def _gains(self, n: Array, rate: Array) -> tuple[Array, Array]:
        """Changes (B, 3) of the vector and the rate from the sample before each block to its last, their units.

        n (B, length, 3) and rate (B, length, 3) of the samples. Rows that are averages do not follow one another.
        """
        before = self._before or (n[0, 0], rate[0, 0])
        self._before = (n[-1, -1], rate[-1, -1])
        if self.averaged:
            return np.zeros_like(n[:, 0]), np.zeros_like(rate[:, 0])
        gains = [np.diff(x[:, -1], axis=0, prepend=first[None]) for x, first in zip((n, rate), before, strict=True)]
        return gains[0], gains[1]

    def _halve(self) -> None:
        """Join neighbours, so that the blocks are twice as long."""
        blocks = self.blocks()
        even = len(blocks) // 2 * 2
        remainder = blocks.at(np.arange(even, len(blocks)))
        self._kept = [blocks.at(np.arange(even)).joined()]
        self.length *= 2
        self._count = even // 2
        if len(remainder):
            self._odd(remainder)

    def _odd(self, remainder: Blocks) -> None:
        """A block without a neighbour is kept as it is: half as long as the others, and weighted so."""
        self._kept.append(replace(remainder, first=np.array([self._count])))
        self._count += 1

    def part(self, chosen: Array, sensors: Array) -> "Ledger":
        """Some of the blocks (B,) bool, and some of the sensors, by number (n,); nothing is added to it."""
        part = copy.copy(self)
        part._kept = [self.blocks().at(chosen).of(sensors)]
        part.reference = self.reference.of(sensors)
        part.ends = (self.ends[0].of(sensors), self.ends[1].of(sensors))
        part.quantum = self.quantum[sensors]
        return part

    def blocks(self) -> Blocks:
        """All blocks so far."""
        if not self._kept:
            return empty_blocks(len(self.reference.names), 0)
        parts = [vars(blocks) for blocks in self._kept]
        joined = Blocks(**{name: np.concatenate([part[name] for part in parts]) for name in parts[0]})
        self._kept = [joined]
        return joined
