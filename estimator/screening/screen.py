"""All that is screened in one raw file, part after part: a part knows what those before it showed."""

from collections.abc import Callable
from functools import partial
from itertools import groupby

import numpy as np

from estimator.message import say
from estimator.screening import samples
from estimator.screening.clock import Clock, Fault
from estimator.screening.findings import Screening, Sighting, seen, together
from estimator.session import ACCELEROMETER, GYROSCOPE, Array, Sensor

JUDGED_BY_PARITY = frozenset({"frozen", "repeated"})
"""Kinds that are not looked for in service: a channel that stands still there is a failing sensor, not a bad record."""

LIVELY = 30.0
"""Steps that a channel moves by where others of its kind cannot stand still: beyond the noise of a coarse one at rest.
"""

BRIEF = 3
"""Rows in a row that a marker of no data may fill in service: a channel at the end of its range for longer fails."""


class Screen:
    """The readings of one raw file: R rows in all, m sensors.

    sensors : of the file.
    declined : kinds that are not to be looked for.
    rate : Hz; None of averaged positions.
    in_service : whether what lasts is left to parity, which judges it as a failing sensor.
    signs : bits of the words without a sign, by kind of sensor, as `signs` of an earlier passage through the file.
    """

    def __init__(
        self,
        sensors: tuple[Sensor, ...],
        declined: frozenset[str],
        rate: float | None,
        signs: dict[str, int] | None = None,
        *,
        in_service: bool = False,
    ) -> None:
        self.sensors, self.rate, self._in_service = sensors, rate, in_service
        self._declined = declined | JUDGED_BY_PARITY if in_service else declined
        self._clock: Clock | None = None
        self._timed = self._read = 0
        self.signs = dict(signs or {})
        self.found: list[Sighting] = []
        kinds = sorted(range(len(sensors)), key=lambda i: sensors[i].kind)
        self._kinds = {kind: np.array(list(group)) for kind, group in groupby(kinds, lambda i: sensors[i].kind)}
        self._constant: dict[int, float | None] = {}
        self._lively: set[int] = set()

    def looks_for(self, kind: str) -> bool:
        """Whether a kind was not declined."""
        return kind not in self._declined

    def note_rate(self, rate: float, rows: int) -> None:
        """Notes that the rate, Hz, comes from the times and not from the file."""
        self.found += seen("rate", (), np.arange(rows), 0, rate)

    def times(self, time: Array, moved: Array, fault: Fault) -> Array:
        """The times (R,) of the next rows, s, corrected; ``moved`` as for `Clock.add`."""
        if self._clock is None:
            self._clock = Clock(self.rate, self._declined, fault)
        corrected, found = self._clock.add(time, self._timed, moved)
        self._timed += len(time)
        self.found += found
        return corrected

    @property
    def clock_stands(self) -> bool:
        """Whether the times never advance and are to be left out, which is then noted as a finding."""
        stands = self._clock is not None and self._clock.stands and self._timed > 1 and self.looks_for("no-clock")
        if stands:
            self.found += seen("no-clock", (), np.arange(self._timed), 0)
        return stands

    def readings(self, readings: Array) -> Array:
        """The readings (R, m) of the next rows, with NaN for those left out; what is given may be changed."""
        at = self._read
        self._read += len(readings)
        values = np.require(readings, float, ["F", "W"])
        self._missing(values, at)
        for kind, channels in self._kinds.items():
            if self.looks_for("sign-lost"):
                self._signs(values, kind, channels, at)
            if self.looks_for("zero-vectors") and (values[:, channels[0]] == 0).any():
                weighed = kind == ACCELEROMETER
                self._vectors("zero-vectors", values, channels, at, partial(samples.zero_vectors, weighed=weighed))
        for i in range(len(self.sensors)):
            self._channel(values, i, at)
        for channels in self._kinds.values():
            if self.looks_for("repeated") and samples.share_of_equal(values[:, channels[0]]) >= samples.OFTEN / 2:
                self._vectors("repeated", values, channels, at, samples.repeated)
        return values

    def _missing(self, values: Array, at: int) -> None:
        for i, sensor in enumerate(self.sensors):
            x = values[:, i]
            if not (x.min(initial=0) >= -samples.LARGEST and x.max(initial=0) <= samples.LARGEST):
                none = np.flatnonzero(~(np.abs(x) <= samples.LARGEST))
                self.found += seen("missing", (sensor.name,), none, at)
                values[none, i] = np.nan

    def _signs(self, values: Array, kind: str, channels: Array, at: int) -> None:
        """Reads the words of a kind with their sign, where one channel shows that they lost it."""
        words = {i: values[:, i] for i in channels if np.fmin.reduce(values[:, i], initial=np.inf) >= 0}
        units = {i: samples.unit_of(x[np.isfinite(x)]) for i, x in words.items()}
        words = {i: x if units[i] == 1 else np.round(x / units[i]) for i, x in words.items()}
        known = {i: x[np.isfinite(x)] for i, x in words.items()}
        if kind not in self.signs:
            of = (samples.without_sign, *([samples.is_just_below_zero] if kind == GYROSCOPE else []))
            bits = next((n for test in of for x in known.values() if (n := test(x)) is not None), None)
            if bits is None:
                return
            self.signs[kind] = bits
        bits = self.signs[kind]
        for i in (i for i, x in known.items() if samples.may_be_unsigned(x, bits)):
            high, wrap = np.flatnonzero(words[i] >= 2.0 ** (bits - 1)), units[i] * 2.0**bits
            self.found += seen("sign-lost", (self.sensors[i].name,), high, at, wrap)
            values[high, i] -= wrap

    def _vectors(self, what: str, values: Array, channels: Array, at: int, of: Callable[[Array], Array]) -> None:
        rows = np.flatnonzero(np.isfinite(values[:, channels]).all(axis=1))
        left = rows[of(values[np.ix_(rows, channels)])]
        if len(left):
            self.found += seen(what, (self.sensors[i].name for i in channels), left, at)
            values[np.ix_(left, channels)] = np.nan

    def _channel(self, values: Array, i: int, at: int) -> None:
        name = (self.sensors[i].name,)
        if self.looks_for("no-data"):
            rows, x = _known(values[:, i])
            for value, none in samples.markers(x):
                if self._in_service and (value not in samples.MARKERS or samples.longest_run(none) > BRIEF):
                    continue
                self.found += seen("no-data", name, rows[none], at, value)
                values[rows[none], i] = np.nan
        rows, x = _known(values[:, i])
        if not len(x):
            return
        low, high = float(x.min()), float(x.max())
        only = low if low == high else None
        self._constant[i] = only if self._constant.get(i, only) == only else None
        if i not in self._lively and high - low > LIVELY * samples.smallest_step(x):
            self._lively.add(i)
        if self.looks_for("saturated"):
            for value in (low, high):
                self.found += seen("saturated", name, rows[samples.at_end(x, value)], at, value)
        if self.looks_for("frozen"):
            still = rows[samples.frozen(x)]
            self.found += seen("frozen", name, still, at)
            values[still, i] = np.nan

    def check(self, fault: Fault) -> None:
        """Records channels that hold nothing in the whole file."""
        if not self.looks_for("frozen"):
            return
        live = {kind for kind, channels in self._kinds.items() if self._lively.intersection(channels)}
        for i in (i for i, only in self._constant.items() if only is not None and self.sensors[i].kind in live):
            text = (
                "reads {value} in every row while others of its kind change: it carries no data; check its connection, "
                "or remove the sensor"
            )
            fault(self.sensors[i].name, say(text, value=f"{self._constant[i]:.10g}"), None)

    @property
    def findings(self) -> Screening:
        """Findings of all rows so far."""
        return together(self.found)


def _known(x: Array) -> tuple[Array, Array]:
    """Rows of x (R,) that hold a number, and what they hold."""
    known = np.isfinite(x)
    return np.flatnonzero(known), x if known.all() else x[known]
