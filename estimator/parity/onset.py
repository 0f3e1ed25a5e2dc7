"""Faults that begin within a recording, and those that last all through it: which sensor, which kind, since when.

In this order, each with a rule of its own: dead sensors, by their raw readings (`standing`); two that are exchanged,
because exchanging them back makes parity quiet; then, sensor by sensor, a course that changes (`scan`, `shapes`), noise
that grows (`signs`). A sensor that has been found takes no part in the search for the next.

Naming. A change along V[i] leaves nothing across but noise and a small part (`SKEW`) by which directions are not
known. A sensor that explains almost as much stays a suspect, by the margin of `hypotheses`. What no one sensor
explains, and no two where six or more allow two, is no fault of a sensor, and nothing is said of it here.
"""

from dataclasses import dataclass, replace
from itertools import combinations
from math import sqrt

import numpy as np
from scipy.special import ndtri

from estimator.parity.course import ParityCourse, course_of
from estimator.parity.lateness import LONGEST, lateness
from estimator.parity.ledger import Ledger
from estimator.parity.reference import FEWEST
from estimator.parity.results import DELAY, EXCHANGED, NOISE, RAMP, CourseFault
from estimator.parity.scan import Scan, critical, tail
from estimator.parity.shapes import FaultShape, shape_of
from estimator.parity.signs import Exchange, Sign, exchange_of, growth_of
from estimator.parity.standing import Standing, standing
from estimator.session import Array
from estimator.significance import critical_chi2

LEVEL = 1e-5
"""Chance that a sound recording is given a fault, if motion is as modelled: far below that of a change."""
SIGN_LEVEL = 1e-6
"""Chance that a sound recording is given a fault of noise or delay: variances of a few samples have longer tails than
normal.
"""
SKEW = 0.1
"""Share of a change, in energy, that may lie across: a third of a radian, by motion meanwhile and clipped samples."""
WRONG_SENSOR = 0.01
"""Chance that the true sensor is passed over, as of `hypotheses`."""
NAMED = 5
"""Sensors that name one; two need one more."""
LATE = 0.85
"""Factor on the critical z for lateness: onsets alone are tried, and the larger noise of two is taken."""
ASKEW = 0.03
"""Share of a change to lateness, in energy, that may lie across; bias, load and clipped samples do not bend it."""
FOLLOWED = 4.0
"""z from which a sensor is late, where parity already flutters with motion as it does beside a late sensor only."""
OVER_NOISE = 2.0
"""Times the critical z from which a course says more than the noise that has grown with it."""
PAIR = 3
"""Dimensions of parity from which on not every two sensors explain a change."""
MOST_FAULTS = 2
"""Sensors that begin to fail in one recording: more have a common cause, which is not theirs."""
FREEDOM = 0.25
"""Degrees of freedom of the noise for every block."""


@dataclass(frozen=True, eq=False)
class Looked:
    """Result of a search: faults, and the sensors, by number, that say nothing any more once it began."""

    faults: tuple[CourseFault, ...]
    silent: tuple[int, ...]


def faults_of(ledger: Ledger, norm: float | None, rate: float | None) -> Looked:
    """Searches a recording for faults.

    Parameters
    ----------
    norm : g, m/s²; None for gyros.
    rate : of the samples, Hz; without one rows are averages, which have no course.
    """
    if rate is None or ledger.averaged:
        return Looked((), ())
    dead = standing(ledger)
    found = [_dead(one, ledger, rate) for one in dead]
    silent = [one.sensor for one in dead]
    sound = [i for i in range(len(ledger.reference.names)) if i not in silent]
    for turn in range(MOST_FAULTS):
        if len(sound) < (NAMED if len(ledger.reference.names) > FEWEST else FEWEST):
            break
        part = ledger.part(np.ones(len(ledger.blocks()), dtype=bool), np.array(sound))
        course = course_of(part, norm, rate)
        if course is None:
            break
        search = Search(course, ledger.length / rate, rate, len(sound) == len(ledger.reference.names))
        faults, gone = search.next()
        if turn:
            faults = [fault for fault in faults if fault.sensor is not None]
        found += faults
        silent += [sound[k] for k in gone if any(f.kind == EXCHANGED for f in faults)]
        sound = [s for k, s in enumerate(sound) if k not in gone]
        if not gone:
            break
    return Looked(tuple(sorted(found, key=lambda f: f.since)), tuple(silent))


def _dead(one: Standing, ledger: Ledger, rate: float) -> CourseFault:
    second = ledger.length / rate
    name = ledger.reference.names[one.sensor]
    return CourseFault(
        sensor=name,
        suspects=(name,),
        kind=one.kind,
        since=(one.first - one.before) * second,
        until=one.until * second if one.until < len(ledger.blocks()) else None,
        since_sigma=second / sqrt(12) if one.first else 0.0,
        size=None,
        sigma=None,
        p_value=one.p_value,
    )


@dataclass(frozen=True, eq=False)
class Search:
    """The next fault of a course."""

    course: ParityCourse
    second: float
    """s of a block of the ledger."""
    rate: float
    """Hz"""
    complete: bool
    """Whether no sensor has been left out, so that flutter and delay in the blocks are those of its sensors alone."""

    def next(self) -> tuple[list[CourseFault], list[int]]:
        """Faults that begin, and the sensors that they take, by number."""
        exchange = exchange_of(self.course)
        if exchange is not None:
            return [self._exchanged(exchange)], list(exchange.pair)
        grown = self._sure(growth_of(self.course))
        scans = [self._scan(i, grown) for i in range(self.m)]
        strongest = np.array([np.abs(z).max() for _, z in scans])
        follows = grown is not None and grown.follows
        late = self._late(FOLLOWED if follows else max(LATE * self.critical, float(strongest.max())))
        if late is not None:
            return late
        i, needed = int(np.argmax(strongest)), self.critical
        if grown is not None and strongest[i] < OVER_NOISE * max(grown.z, self.critical):
            i, needed = grown.sensor, OVER_NOISE * self.critical
        if strongest[i] > needed:
            return self._changed(i, *scans[i], grown, tail(strongest[i], self.tests, self.freedom))
        return ([], []) if grown is None else self._grown(grown)

    def _late(self, least: float) -> tuple[list[CourseFault], list[int]] | None:
        """The sensor that comes late from some moment on, if its z is at least so much."""
        d = self.course.p.shape[1]
        alone = critical_chi2(LEVEL, d - 1, self.freedom) if d > 1 else np.inf
        seen = lateness(self.course, self.rate)
        own = [
            one
            for one in seen
            if one.across <= alone + ASKEW * (one.across + one.shape.square) and one.delay <= LONGEST
        ]
        own.sort(key=lambda one: -one.z)
        if not own or own[0].z < least:
            return None
        best = own[0]
        near = [one.sensor for one in own[1:] if one.z > 0 and one.z**2 > best.z**2 - self._margin]
        if d > 1 and len(near) > 1:
            return [], []
        p = tail(best.z, self.tests, self.freedom)
        return [self._dated(best.shape, [best.sensor, *near], DELAY, best.delay, best.sigma, p)], (
            [] if near else [best.sensor]
        )

    def _sure(self, sign: Sign | None) -> Sign | None:
        """The sign, if it is sure; blocks of fewer sensors than the ledger's hold no signs that are theirs alone."""
        sure = sign is not None and self.complete and tail(sign.z, self.tests, self.freedom) < SIGN_LEVEL
        return sign if sure else None

    def _scan(self, sensor: int, grown: Sign | None) -> tuple[Scan, Array]:
        noisier = grown.noisier if grown is not None and grown.sensor == sensor else 0.0
        scan = self.course.scan(sensor, noisier=noisier)
        return scan, scan.intervals()

    @property
    def m(self) -> int:
        """Sensors."""
        return len(self.course.reference.names)

    @property
    def tests(self) -> float:
        """Sensors, moments and scales that are looked at."""
        T = len(self.course.p)
        return self.m * T * float(np.log2(T))

    @property
    def freedom(self) -> float:
        """Degrees of freedom of the noise."""
        return FREEDOM * len(self.course.p)

    @property
    def critical(self) -> float:
        """z from which on a change is one."""
        return critical(LEVEL, self.tests, self.freedom)

    @property
    def _margin(self) -> float:
        """z² by which a sensor must explain more than another to be told from it."""
        return float(ndtri(WRONG_SENSOR / max(self.m - 1, 1))) ** 2

    def _changed(
        self, i: int, scan: Scan, z: Array, grown: Sign | None, p: float
    ) -> tuple[list[CourseFault], list[int]]:
        """The sensor and kind behind the strongest change."""
        shape = shape_of(self.course, scan, i, z)
        if shape.kind == DELAY and grown is not None and grown.sensor == i:
            shape = replace(shape, since=grown.shape.since, since_sigma=grown.shape.since_sigma)
        g = scan.whitened(shape.shape[:, None])[:, 0]
        seen = g @ scan.whitened(self.course.p) / np.linalg.norm(g)
        u = np.stack([self.course.along(k)[0] for k in range(self.m)])
        along, total = (u @ seen) ** 2, float(seen @ seen)
        d = len(seen)
        if d > 1 and total - along[i] > critical_chi2(LEVEL, d - 1, self.freedom) + SKEW * total:
            return self._two(shape, scan, seen, u, p)
        near = [int(k) for k in np.argsort(-along) if k != i and (d == 1 or along[k] > along[i] - self._margin)]
        if d > 1 and len(near) > 1:
            return [], []
        return [self._fault(shape, scan, [i, *near], p)], [] if near else [i]

    def _two(
        self, shape: FaultShape, scan: Scan, seen: Array, u: Array, p: float
    ) -> tuple[list[CourseFault], list[int]]:
        """Two sensors that change at one moment; nothing where two do not explain it, or any two would."""
        d, total = len(seen), float(seen @ seen)
        if d < PAIR:
            return [], []
        left = {}
        for pair in combinations(range(self.m), 2):
            basis = np.linalg.qr(u[list(pair)].T)[0]
            left[pair] = total - float(((basis.T @ seen) ** 2).sum())
        best = min(left, key=lambda pair: left[pair])
        if left[best] > critical_chi2(LEVEL, d - 2, self.freedom) + SKEW * total:
            return [], []
        return [self._fault(shape, scan, [k], p) for k in best], list(best)

    def _fault(self, shape: FaultShape, scan: Scan, suspects: list[int], p: float) -> CourseFault:
        """A fault of the first of the suspects, by number; named if it is the only one."""
        unit = {RAMP: 1.0 / (self.course.span * self.second), DELAY: 1.0 / self.rate}.get(shape.kind, 1.0)
        size, sigma = (x * unit / self.course.along(suspects[0])[2] for x in scan.size(shape.shape))
        return self._dated(shape, suspects, shape.kind, size, sigma, p)

    def _grown(self, sign: Sign) -> tuple[list[CourseFault], list[int]]:
        """Noise, or motion that comes late."""
        alone = self.course.p.shape[1] > 1
        suspects = [sign.sensor] if alone else [sign.sensor, *(k for k in range(self.m) if k != sign.sensor)]
        p = tail(sign.z, self.tests, self.freedom)
        kind, size, sigma = (DELAY, None, None) if sign.follows else (NOISE, sign.size, sign.sigma)
        return [self._dated(sign.shape, suspects, kind, size, sigma, p)], [sign.sensor] if alone else []

    def _dated(
        self, shape: FaultShape, suspects: list[int], kind: str, size: float | None, sigma: float | None, p: float
    ) -> CourseFault:
        names = tuple(self.course.reference.names[k] for k in suspects)
        return CourseFault(
            sensor=names[0] if len(names) == 1 else None,
            suspects=names,
            kind=kind,
            since=self._moment(shape.since),
            until=None if shape.until is None else self._moment(shape.until),
            since_sigma=shape.since_sigma * self.course.span * self.second,
            size=size,
            sigma=sigma,
            p_value=p,
        )

    def _exchanged(self, exchange: Exchange) -> CourseFault:
        names = tuple(self.course.reference.names[k] for k in exchange.pair)
        sigma = self.course.span * self.second / sqrt(12) if exchange.since else 0.0
        p = tail(float(np.sqrt(exchange.square)), self.tests, self.freedom)
        since = self._moment(exchange.since) if exchange.since else 0.0
        return CourseFault(names[0], names, EXCHANGED, since, None, sigma, None, None, p)

    def _moment(self, blocks: float) -> float:
        """s since the start."""
        return (self.course.start + blocks * self.course.span) * self.second
