"""Findings of a screening, as facts that add up over the parts of a file, and each in a sentence."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from estimator.message import joined, say, say_count
from estimator.session import CORRECTED_SAMPLES, LEFT_OUT, NOTED, ScreenFinding

Screening = tuple[ScreenFinding, ...]
"""All findings in one file."""

OFF = "off"
"""The word that declines all kinds."""

ACTIONS = {
    "missing": LEFT_OUT, "no-data": LEFT_OUT, "sign-lost": CORRECTED_SAMPLES, "zero-vectors": LEFT_OUT,
    "frozen": LEFT_OUT, "repeated": LEFT_OUT, "wild": LEFT_OUT, "saturated": NOTED, "clock": CORRECTED_SAMPLES,
    "stamps": CORRECTED_SAMPLES, "doubled": NOTED, "no-clock": LEFT_OUT, "time-unit": CORRECTED_SAMPLES,
    "rate": CORRECTED_SAMPLES, "gaps": NOTED,
}  # fmt: skip
"""Kind → what is done about it."""
KINDS = tuple(ACTIONS)
"""All kinds, by the names under which a session file declines them."""


def declined_by(stated: object) -> tuple[str, ...] | None:
    """The kinds that a file declines in its own words; None where they are no such thing."""
    if stated is None:
        return ()
    if stated == OFF:
        return KINDS
    listed = tuple(stated) if isinstance(stated, list | tuple) else None
    return None if listed is None or any(kind not in KINDS for kind in listed) else listed


TEMPLATES = {
    "missing": "No reading in {rows} of {sensors} (empty, no number, or beyond any instrument): left out.",
    "no-data": "{value} in {rows} of {sensors} carries no data (a marker, or the end of the range): left out.",
    "sign-lost": "{sensors} jumps by {value} between neighbouring samples: read without its sign. Corrected in {rows}.",
    "zero-vectors": "{sensors} are exactly 0 together in {rows} between others: no reading was there. Left out.",
    "frozen": "{sensors} stands at exactly one value for long in {rows}, but scatters elsewhere: left out.",
    "repeated": "Readings of {sensors} are repeated in {rows}: logged faster than they were taken. The repeats are "
    "left out, and standard errors are those of the distinct readings.",
    "wild": "{sensors} lies far from all others of its rest in {rows}: left out of the mean.",
    "saturated": "{sensors} stands at {value}, the end of its range, in {rows}.",
    "clock": "The clock falls back by {value} s less a step in row {first}: a counter that rolled over. "
    "{value} s were added from there on.",
    "stamps": "Times out of order in {rows}: replaced by those between their neighbours.",
    "doubled": "The time of the row before stands again in {rows}.",
    "no-clock": "time_s never advances: left out, and times taken from sample_rate_hz.",
    "time-unit": "time_s advances {value} times as fast as sample_rate_hz says: taken for another unit, and divided.",
    "rate": "No sample_rate_hz is stated, but time_s advances evenly: read as a raw log of {value} samples a second.",
    "gaps": "Samples are missing: time_s leaps in {rows}, by {value} s at most.",
}
"""Kind → how it is said, every one with the same places."""


@dataclass(frozen=True)
class Sighting:
    """One kind of thing in some rows, counted from 0 within the whole file."""

    kind: str
    sensors: tuple[str, ...]
    rows: int
    first: int
    last: int
    value: float | None = None
    """Value found in the readings or the clock; None where there is none to report."""

    def beside(self, other: "Sighting") -> "Sighting":
        """The sighting merged with the same one in another part of the file."""
        value = max((v for v in (self.value, other.value) if v is not None), default=None)
        both = tuple(dict.fromkeys((*self.sensors, *other.sensors)))
        return Sighting(
            self.kind, both, self.rows + other.rows, min(self.first, other.first), max(self.last, other.last), value
        )

    @property
    def finding(self) -> ScreenFinding:
        """The finding, for people."""
        first, last = self.first + 1, self.last + 1
        parts = {
            "rows": _rows(self.rows, first, last),
            "sensors": joined(", ", self.sensors),
            "value": "" if self.value is None else plain(self.value),
            "first": first,
        }
        template = TEMPLATES[self.kind]
        used = {name: part for name, part in parts.items() if f"{{{name}}}" in template}
        message = say(template, **used)
        return ScreenFinding(self.kind, self.sensors, self.rows, first, last, ACTIONS[self.kind], message)


def _rows(rows: int, first: int, last: int) -> str:
    return say_count("{n} row ({first})", "{n} rows ({first} to {last})", rows, n=f"{rows:,}", first=first, last=last)


def plain(value: float) -> str:
    """``−32768`` as it stands in a file, ``4294.967296``, ``1e+30``."""
    return f"{value:.0f}" if value == np.floor(value) and abs(value) < 2**33 else f"{value:.10g}"


def seen(kind: str, sensors: Iterable[str], rows: np.ndarray, at: int, value: float | None = None) -> list[Sighting]:
    """The thing in ``rows`` (k,), numbers from 0 within a part that begins at row ``at``; nothing where none is."""
    if not len(rows):
        return []
    return [Sighting(kind, tuple(sensors), len(rows), at + int(rows[0]), at + int(rows[-1]), value)]


def together(found: Iterable[Sighting]) -> tuple[ScreenFinding, ...]:
    """Merges findings of one kind and value, and joins sensors that share their rows."""
    sums: dict[tuple[str, tuple[str, ...], float | None], Sighting] = {}
    for item in found:
        key = (item.kind, item.sensors, item.value if item.kind in ("no-data", "saturated") else None)
        sums[key] = sums[key].beside(item) if key in sums else item
    shared: dict[tuple[object, ...], Sighting] = {}
    for item in sums.values():
        alike = (item.kind, item.rows, item.first, item.last, item.value)
        same = shared.get(alike)
        shared[alike] = item if same is None else replace(same, sensors=(*same.sensors, *item.sensors))
    return tuple(item.finding for item in shared.values())
