"""Sums over the rests of a log, taken part by part.

Everything is summed as its difference from the first sample of its rest, so that no digits are lost. With x the n
samples of a rest, s₁ = Σx and s₂ = Σx², the variance of a sample is (s₂ − s₁²/n)/(n − 1).
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from estimator.errors import FormatError, problem_at
from estimator.message import say
from estimator.rest_noise import block_count, waves_of
from estimator.rest_tilt import MeanErrors, errors_of_means
from estimator.screening import without_wild
from estimator.screening.findings import Sighting, together
from estimator.screening.gaps import stray
from estimator.screening.wild import BLOCK
from estimator.session import ACCELEROMETER, Array, CalibrationSession, Sensor
from estimator.static import (
    PIECES,
    Intervals,
    TiltResponse,
    contiguous,
    errors_of_kinds,
    far_turn,
    long_enough_to_move,
    turned,
)

SET = ("flipped", "beta", "directions", "position")
"""Columns that are set rather than read: taken from the first sample of a rest."""
AVERAGED = ("time", "temperature")
"""Columns that are averaged beside the readings."""


class RowTally:
    """The sums over the rests of one log, n of them, and what follows from them. m sensors, c columns.

    Columns come first while they are summed: (c, r) of the r rows of a part, because each then lies in one piece.
    """

    def __init__(self, head: CalibrationSession, rests: Intervals) -> None:
        self.head, self.rests = head, rests
        self.blocks = block_count(rests.samples) or 1
        n, m = len(rests), len(head.sensors)
        self._averaged = [name for name in AVERAGED if getattr(head, name) is not None]
        self._edges, self._rank = edges(rests, self.blocks)
        self._first = np.zeros((n, m + len(self._averaged)))
        self._sums = np.zeros((n, self._edges.shape[1] - 1, m + len(self._averaged)))
        self._squares = np.zeros((n, m))
        self._ends = np.zeros((n, m, 2))
        self._range = np.array([[-np.inf, np.inf]]).repeat(m, axis=0)
        self._reached = np.empty((0, 2), np.intp)  # channels and ends that this part comes to
        self._missing = np.zeros((0, *self._sums.shape[1:]))  # of as many rests as sums, from the first that misses any
        self._stray: list[Sighting] = []
        self._pending = np.empty((m + len(self._averaged), 0))  # of a rest, until a block of it is whole
        named = [name for name in SET if getattr(head, name) is not None]
        self._set: dict[str, Array] = {
            name: np.zeros((n, *getattr(head, name).shape[1:]), getattr(head, name).dtype) for name in named
        }

    def add(self, part: CalibrationSession, at: int) -> None:
        """The rows from ``at`` on."""
        values = np.vstack([part.readings.T, *(getattr(part, name) for name in self._averaged)])
        self._note_range(values[: len(self._range)])
        begin = int(np.searchsorted(self.rests.stop, at, "right"))
        end = int(np.searchsorted(self.rests.start, at + values.shape[1], "left"))
        for i in range(begin, end):
            if self.rests.start[i] >= at:
                self._begin(i, part, int(self.rests.start[i]) - at, values)
            self._add(i, values, at)

    def _note_range(self, readings: Array) -> None:
        """A new end of a channel's range: no rest was there before."""
        seen = np.column_stack([np.fmax.reduce(readings, axis=1), np.fmin.reduce(readings, axis=1)])
        farther = np.column_stack([seen[:, 0] > self._range[:, 0], seen[:, 1] < self._range[:, 1]])
        self._ends[:, farther] = 0
        self._range[farther] = seen[farther]
        self._reached = np.argwhere(seen == self._range)

    def _begin(self, i: int, part: CalibrationSession, row: int, values: Array) -> None:
        first = values[:, row]
        if np.isnan(first).any():
            known = np.isfinite(values[:, row:])
            beside = values[np.arange(len(values)), row + known.argmax(axis=1)]
            first = np.where(np.isnan(first), np.nan_to_num(beside), first)
        self._first[i] = first
        for name, stored in self._set.items():
            stored[i] = getattr(part, name)[row]

    def _add(self, i: int, values: Array, at: int) -> None:
        """The rows of rest i that are in this part."""
        start, stop = int(self.rests.start[i]), int(self.rests.stop[i])
        begin, end = max(start - at, 0), min(stop - at, values.shape[1])
        samples = values[:, begin:end]
        for channel, side in self._reached:
            self._ends[i, channel, side] += np.count_nonzero(samples[channel] == self._range[channel, side])
        at += begin - self._pending.shape[1]
        samples = np.concatenate([self._pending, samples], axis=1)
        seen = at + samples.shape[1]
        ready = seen - at if seen == stop else start + (seen - start) // BLOCK * BLOCK - at
        self._pending = samples[:, ready:].copy()
        if ready:
            self._sum(i, samples[:, :ready], at)

    def _sum(self, i: int, samples: Array, at: int) -> None:
        """Rows of rest i from row ``at`` on, whole blocks."""
        inside, m = np.clip(self._edges[i] - at, 0, samples.shape[1]), len(self._range)
        starts = np.flatnonzero(np.diff(inside))
        wild = None if "wild" in self.head.unscreened else without_wild(samples[:m].T)
        if wild is not None:
            samples[:m][wild.T] = np.nan
            self._stray += stray(self.head.sensors, wild, at)
        away = samples - self._first[i, :, None]
        begins = inside[starts] - inside[0]
        sums = np.add.reduceat(away, begins, axis=1).T
        if np.isnan(sums).any():
            none = np.isnan(away)
            if not len(self._missing):
                self._missing = np.zeros_like(self._sums)
            self._missing[i, starts] += np.add.reduceat(none.astype(float), begins, axis=1).T
            away[none] = 0.0
            sums = np.add.reduceat(away, begins, axis=1).T
        self._sums[i, starts] += sums
        self._squares[i] += np.einsum("jr,jr->j", away[:m], away[:m])

    def at(self, chosen: NDArray[np.bool_]) -> "RowTally":
        """The tally of the rests ``chosen`` (n,)."""
        other = RowTally(self.head, self.rests.at(chosen))
        for name in ("_first", "_sums", "_squares", "_ends"):
            setattr(other, name, getattr(self, name)[chosen])
        other._range, other._stray = self._range, self._stray
        other._missing = self._missing[chosen] if len(self._missing) else self._missing
        other._set = {name: stored[chosen] for name, stored in self._set.items()}
        return other

    def _between(self, sums: Array) -> Array:
        """(n, edges, c) sums from the start of a rest to each of its edges, in the order of `edges`."""
        up_to = np.concatenate([np.zeros_like(sums[:, :1]), np.cumsum(sums, axis=1)], axis=1)
        return np.take_along_axis(up_to, self._rank[..., None], axis=1)

    def _held(self, first: int, last: int | None) -> Array:
        """(n, pieces, c) samples that are known between the edges ``first`` to ``last``, at least one."""
        lengths = np.diff(np.take_along_axis(self._edges, self._rank, axis=1)[:, first:last], axis=1)[..., None]
        if not len(self._missing):
            return np.broadcast_to(np.maximum(lengths, 1), (*lengths.shape[:2], self._sums.shape[2]))
        return np.maximum(lengths - np.diff(self._between(self._missing)[:, first:last], axis=1), 1)

    @property
    def known(self) -> Array:
        """(n, c) samples of every rest that are numbers."""
        missing = self._missing.sum(axis=1) if len(self._missing) else 0.0
        return np.asarray(self.rests.samples[:, None] - missing + np.zeros(self._first.shape))

    def drift(self) -> Array:
        """(n, m) range of the means of the quarters, reading units."""
        m = self._squares.shape[1]
        quarters = np.diff(self._between(self._sums)[:, self.blocks + 1 : -1, :m], axis=1)
        return np.asarray(np.ptp(quarters / self._held(self.blocks + 1, -1)[..., :m], axis=1))

    def may_move(self) -> bool:
        """Whether a quarter differs so far that the noise from sample to sample must be known."""
        if not long_enough_to_move(self.rests):
            return False
        drift = self.drift()
        return any((drift[:, i] > far_turn(sensor)).any() for i, sensor in self._accelerometers())

    def moving(self, jitter: Array) -> NDArray[np.bool_]:
        """(n,) rests in which the block moves, as `estimator.static.moving`; ``jitter`` (n, m) sums of the squared
        changes, reading units squared.
        """
        moves = np.zeros(len(self.rests), dtype=bool)
        noise = jitter / (2 * self.rests.samples * (self.rests.samples // PIECES))[:, None]
        drift = self.drift()
        for i, sensor in self._accelerometers():
            moves |= turned(sensor, drift[:, i], noise[:, i])
        return moves

    def _accelerometers(self) -> list[tuple[int, Sensor]]:
        return [(i, sensor) for i, sensor in enumerate(self.head.sensors) if sensor.kind == ACCELEROMETER]

    def session(self, tilts: TiltResponse | None = None) -> CalibrationSession:
        """One row a rest, as `estimator.static.average` makes of its intervals."""
        rows = self._averaged_rows()
        response = None if tilts is None else tilts(rows)
        if response is None:
            return rows
        errors = self._errors(response)
        return replace(rows, standard_errors=errors.alone, tilt_error=errors.tilt)

    @property
    def _spread(self) -> Array:
        """(n, m) sums of squares about the mean, reading units squared."""
        sums = self._sums[..., : self._squares.shape[1]].sum(axis=1)
        return np.maximum(self._squares - sums**2 / np.maximum(self.known[:, : sums.shape[1]], 1), 0.0)

    def _averaged_rows(self) -> CalibrationSession:
        head, samples, m = self.head, self.rests.samples, len(self.head.sensors)
        known = np.maximum(self.known, 1)
        assert head.sample_rate is not None
        means = self._first + self._sums.sum(axis=1) / known
        scale = np.array([sensor.nominal_scale for sensor in head.sensors])
        averages = dict(zip(self._averaged, means[:, m:].T, strict=True))
        middle = (self.rests.start + self.rests.stop - 1) / 2 / head.sample_rate
        return replace(
            head,
            readings=means[:, :m],
            standard_errors=self._errors().alone,
            at_ends=self._ends / samples[:, None, None],
            vibration=self._spread / known[:, :m] / scale**2,
            time=averages.get("time", middle),
            temperature=averages.get("temperature"),
            flipped=self._set.get("flipped"),
            beta=self._set.get("beta"),
            directions=self._set.get("directions"),
            position=self._set.get("position"),
            turn_angle=None,
            turn_rate=None,
            sample_rate=None,
            counts_averaged=samples.astype(float) if contiguous(head) else None,
            screening=together(self._stray),
        )

    def _errors(self, response: Array | None = None) -> MeanErrors:
        return errors_of_kinds(self.head, self._errors_of_kind, response)

    def _errors_of_kind(self, channels: list[int], response: Array | None) -> MeanErrors:
        """Errors of the means of some channels, as `estimator.static.mean_errors`."""
        samples = self.rests.samples
        if samples.max() < 2:
            return MeanErrors(np.full((len(samples), len(channels)), np.nan))
        single = samples < 2
        sums = np.diff(self._between(self._sums)[:, : self.blocks + 1, channels], axis=1)
        held, known = self._held(0, self.blocks + 1)[..., channels], np.maximum(self.known[:, channels], 1)
        whole = (self._sums.sum(axis=1)[:, channels] / known)[:, None]
        means = np.where(self._empty(channels), whole, sums / held)
        variance = self._spread[:, channels] / np.maximum(known - 1, 1)
        means[single], variance[single] = np.nan, np.nan
        return errors_of_means(waves_of(means, variance, samples, known), response)

    def _empty(self, channels: list[int]) -> Array:
        """(n, B, k) blocks of which nothing is known: they are taken to read as the whole rest."""
        if not len(self._missing):
            return np.zeros((len(self.rests), self.blocks, 1), dtype=bool)
        edges = np.take_along_axis(self._edges, self._rank, axis=1)[:, : self.blocks + 1]
        missing = np.diff(self._between(self._missing)[:, : self.blocks + 1, channels], axis=1)
        return np.asarray(missing >= np.diff(edges, axis=1)[..., None])


def edges(rests: Intervals, blocks: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """(n, e) ends of the blocks, of the quarters, and of the rest, sorted; and the place of each among them."""
    samples, start = rests.samples[:, None], rests.start[:, None]
    cut = start + np.arange(blocks + 1) * (samples // blocks)
    quarters = start + np.arange(PIECES + 1) * (samples // PIECES)
    all_edges = np.column_stack([cut, quarters, rests.stop])
    order = np.argsort(all_edges, axis=1, kind="stable")
    return np.take_along_axis(all_edges, order, axis=1), np.argsort(order, axis=1, kind="stable")


def check_alike(head: CalibrationSession, part: CalibrationSession, at: int) -> None:
    """FormatError where a column is empty in some parts only."""
    for name in (*SET, *AVERAGED):
        if (getattr(head, name) is None) != (getattr(part, name) is None):
            rows = say("rows {first} to {last}", first=at + 1, last=at + len(part.readings))
            raise FormatError(
                [problem_at(name, "is stated in some parts of the log and not in {rows}, or only there", rows=rows)]
            )
