"""Times of a file: counters that roll over, stamps out of order or doubled, another unit than the rate says.

A counter that rolls over falls back by its whole range less one step: the size of the fall tells the range. A fall of
any other size is the start of another recording.
"""

from collections.abc import Callable

import numpy as np

from estimator.message import say
from estimator.screening.findings import Sighting, plain, seen
from estimator.session import Array

DAY = 86_400.0
"""s; clocks that show the time of day."""
WEEK = 7 * DAY
"""s; clocks of satellite navigation."""
RANGES = np.array(
    sorted({2.0**bits * unit for bits in (16, 24, 31, 32) for unit in (1e-9, 1e-6, 1e-3, 1.0)} | {DAY, WEEK})
)
"""s after which clocks begin anew: words of ticks of ns, µs, ms and s."""
CLOSE = 0.5
"""Largest difference, in steps, between the fall and the range less a step."""
FINE = 50.0
"""Steps that a range holds at least: fewer, and any fall is near one."""
UNITS = (1e3, 1e6, 1e9)
"""Times as fast: milli-, micro- and nanoseconds under seconds."""
LIKE = 1.05
"""Ratio within which a rate and the times agree, up to their rounding and some lost samples."""
UNLIKE = 5.0
"""Ratio beyond which they contradict each other: a batch's shared stamps and gaps stay below."""
LEAP = 2.5
"""Steps from which samples are missing: jitter does not double a step."""
SHORTEST_REST = 1.0
"""s; a position takes longer than that to set and to measure, so rows that follow faster are samples."""
SAMPLES = 100
"""Rows from which they are taken for samples, if their times say so."""
MOST_POSITIONS = 2_000
"""Rows beyond those of any stand: a position in half a minute, day and night, for most of a day."""
EVEN = 0.8
"""Share of the steps that lie within a half of the usual one in an even clock; the others are gaps and jitter."""

Fault = Callable[[str, str, int | None], None]
"""Records a problem of a field, in a row counted from 1 or in all."""


def usual_step(time: Array) -> float:
    """Median of the steps forward of times (R,), s; 0 where there is none."""
    steps = np.diff(time)
    steps = steps[steps > 0]
    return float(np.median(steps)) if len(steps) else 0.0


class Clock:
    """The times of one file, part after part."""

    def __init__(self, rate: float | None, declined: frozenset[str], fault: Fault) -> None:
        self.rate, self._declined, self._fault = rate, declined, fault
        self._added, self._last, self._per_unit, self._advanced = 0.0, np.nan, 1.0, False

    def add(self, time: Array, at: int, moved: Array) -> tuple[Array, list[Sighting]]:
        """The times (R,) of the next rows, from row ``at`` on, and what was found; ``moved`` (R,) where a row stands in
        another position than the one before, so that its time may leap."""
        if at == 0 and self.rate is not None:
            self._per_unit, found = self._unit(time)
        else:
            found = []
        time = time / self._per_unit + self._added
        time, new = self._rolled(time, at)
        found += new
        if self.rate is not None:
            found += self._uneven(time, at, moved)
        self._last, self._advanced = time[-1], self._advanced or bool(np.ptp(time) > 0)
        return time, found

    def _unit(self, time: Array) -> tuple[float, list[Sighting]]:
        """The factor by which the clock runs too fast, by the stated rate, and the finding of it."""
        step = usual_step(time)
        assert self.rate is not None
        if step == 0:
            return 1.0, []
        ratios = [step * self.rate, abs(time[-1] - time[0]) / max(len(time) - 1, 1) * self.rate]
        times = next((unit for unit in UNITS if 1 / LIKE < ratios[0] / unit < LIKE), None)
        if times is not None and "time-unit" not in self._declined:
            return times, seen("time-unit", (), np.arange(len(time)), 0, times)
        if "time-unit" not in self._declined and all(not 1 / UNLIKE < ratio < UNLIKE for ratio in ratios):
            text = "advances by {step} s a row, which is {seen} Hz and not {rate}; correct time_s or sample_rate_hz"
            parts = {"step": f"{step:.4g}", "seen": f"{1 / step:.4g}", "rate": f"{self.rate:.6g}"}
            self._fault("time_s", say(text, **parts), None)
        return 1.0, []

    def _rolled(self, time: Array, at: int) -> tuple[Array, list[Sighting]]:
        """Mends every fall that reveals its range; the others are faults."""
        begin = np.append(self._last, time)
        steps = np.diff(begin)
        fallen = np.flatnonzero(steps < 0)
        if not len(fallen):
            return time, []
        usual, found, time = usual_step(time), [], time.copy()
        for j in fallen.tolist():
            before, fall = (time[j - 1] if j else self._last), 0.0
            fall = before - time[j]
            if fall <= 0:  # mended with an earlier one
                continue
            near = RANGES[(np.abs(RANGES - fall - usual) <= CLOSE * usual) & (FINE * usual <= RANGES)]
            if len(near) and "clock" not in self._declined:
                self._added += near[0]
                time[j:] += near[0]
                found += seen("clock", (), np.array([j]), at, float(near[0]))
            elif self.rate is not None and 0 < j < len(time) - 1 and time[j + 1] > time[j - 1] and self._may_mend:
                time[j] = (time[j - 1] + time[j + 1]) / 2
                found += seen("stamps", (), np.array([j]), at)
            elif self.rate is not None and j > 1 and time[j - 2] < time[j] and self._may_mend:
                time[j - 1] = (time[j - 2] + time[j]) / 2
                found += seen("stamps", (), np.array([j - 1]), at)
            else:
                self._back(before, time[j], usual, at + j + 1, near)
                break
        return time, found

    @property
    def _may_mend(self) -> bool:
        return "stamps" not in self._declined

    def _back(self, before: float, now: float, usual: float, row: int, near: Array) -> None:
        parts = {"before": f"{before:.10g}", "now": f"{now:.10g}"}
        if len(near):
            text = "the clock falls from {before} to {now} s: a counter that rolls over; add {range} s from there on"
            self._fault("time_s", say(text, **parts, range=plain(float(near[0]))), row)
        else:
            text = (
                "the clock falls from {before} to {now} s: it restarts there, so these are two recordings; split the "
                "file there, or give its rows in the order measured"
            )
            self._fault("time_s", say(text, **parts), row)

    def _uneven(self, time: Array, at: int, moved: Array) -> list[Sighting]:
        """Doubled stamps, and gaps."""
        usual, steps = usual_step(time), np.diff(time, prepend=self._last if at else time[0] - 1)
        if usual == 0:
            return []
        found = []
        if "doubled" not in self._declined:
            found += seen("doubled", (), np.flatnonzero(steps == 0), at)
        leaps = np.flatnonzero((steps > LEAP * usual) & ~moved & (np.arange(at, at + len(time)) > 0))
        if "gaps" not in self._declined and len(leaps):
            found += seen("gaps", (), leaps, at, float(steps[leaps].max()))
        return found

    @property
    def stands(self) -> bool:
        """Whether every time equalled the one before."""
        return not self._advanced


def rate_of(time: Array) -> float | None:
    """Samples a second of rows that follow one another evenly and too fast for positions; None of any others."""
    if len(time) < SAMPLES:
        return None
    step, steps = usual_step(time), np.diff(time)
    even = np.abs(steps - step) <= CLOSE * step
    if not 0 < step < SHORTEST_REST or even.mean() < EVEN:
        return None
    return float(f"{1 / steps[even].mean():.6g}")


def no_rate(rows: int, time: Array | None, held: float | None) -> str:
    """The problem of so many rows, which are samples, without their rate."""
    if time is None:
        advice = say("for a raw log give sample_rate_hz")
    elif np.ptp(time) == 0:
        advice = say("its time_s never advances: write it with all its digits, or give sample_rate_hz")
    else:
        advice = say(
            "for a raw log give sample_rate_hz; time_s advances by {step} a row", step=f"{usual_step(time):.4g}"
        )
    if held is None:
        return say("has {rows} rows, more than any stand has positions; {advice}", rows=f"{rows:,}", advice=advice)
    text = 'has some {held} rows at each position, as samples are; {advice}, or decline it: "screening": ["rate"]'
    return say(text, held=f"{held:.0f}", advice=advice)
