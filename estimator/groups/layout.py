"""Hypotheses of a group: which columns of which sessions share one amplitude.

A sensor cause may be one unit's (its sensor), a type's (the sensor of that name in every unit, or every sensor of a
kind) or a stand's (every sensor of a kind of every unit on it, while on it); a cause of stand or fixture is the
stand's. All of them are held against the same sessions, so that the level is chosen as the cause is. A hypothesis has
no columns in sessions that it does not speak of.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.groups.candidates import lasting_causes
from estimator.groups.statistics import HARMONIC, SessionStatistics
from estimator.session import Array

UNIT, TYPE, STAND = "unit", "type", "stand"
LEVELS = (UNIT, TYPE, STAND)
TERMS = "terms"
"""Takes the place of a cause: nameless structure that terms of the library describe."""
EVERY = "*"
"""Takes the place of a sensor's name: every sensor of the kind."""

SHARES = {
    UNIT: {UNIT: 0.5, TYPE: 0.0, STAND: 0.5},
    TYPE: {UNIT: 0.3, TYPE: 0.4, STAND: 0.3},
    STAND: {UNIT: 0.3, TYPE: 0.2, STAND: 0.5},
}
"""Prior share of the levels of hypotheses in a group of each level: most to the group's own, for which it is pooled."""

SHARED = 0.2
"""Part of a level's share that sensor causes on every sensor of a kind have."""


@dataclass(frozen=True)
class GroupHypothesis:
    """A cause (or nameless structure) of a unit, a type or a stand, at a place, in a shape."""

    level: str
    subject: str
    """Serial of the unit, name of the type or id of the stand."""
    cause: str
    sensor: str
    """Empty for what acts on the applied vector, `EVERY` for every sensor of the kind."""
    kind: str
    shape: float | None
    width: int
    words: tuple[str, ...] = ()
    """Factors that terms of the library multiply."""

    @property
    def nameless(self) -> bool:
        return self.cause in (HARMONIC, TERMS)

    @property
    def group(self) -> tuple[str, str, str, str, str]:
        """The thing that is named: all its shapes are one."""
        return self.level, self.subject, self.cause, self.sensor, self.kind


@dataclass(frozen=True, eq=False)
class Part:
    """One session in the layout. E columns: its own D, then sums over the sensors of a kind."""

    statistics: SessionStatistics
    sums: tuple[tuple[int, ...], ...]
    """The own columns that each further column adds up."""
    hypotheses: dict[int, Array]
    """Width → (k,) numbers of the hypotheses of that width that the session speaks of."""
    columns: dict[int, Array]
    """Width → (k, w) their columns here."""


@dataclass(frozen=True, eq=False)
class GroupLayout:
    """The hypotheses of a group, by width, and its sessions."""

    hypotheses: dict[int, tuple[GroupHypothesis, ...]]
    log_prior: dict[int, Array]
    """Width → (H,) ln of the prior share; −∞ for nameless structure."""
    parts: tuple[Part, ...]

    @classmethod
    def of(cls, sessions: Sequence[SessionStatistics], level: str) -> "GroupLayout":
        """The layout of sessions, oldest first."""
        wide, known, parts = level != UNIT, {}, []
        numbers: dict[int, dict[GroupHypothesis, int]] = {}
        alike: dict[tuple[str, str, str], Part] = {}
        for s in sessions:
            before = alike.get((s.unit, s.unit_type, s.stand))
            if before is not None and before.statistics.blocks == s.blocks:
                parts.append(replace(before, statistics=s))
                continue
            placed, sums = _places(s, wide)
            found: dict[int, list[tuple[int, Array]]] = {}
            for h, columns in placed:
                table = numbers.setdefault(h.width, {})
                found.setdefault(h.width, []).append((table.setdefault(h, len(table)), columns))
                known[h] = True
            parts.append(
                Part(
                    s,
                    sums,
                    {w: np.array([n for n, _ in rows]) for w, rows in found.items()},
                    {w: np.array([c for _, c in rows]) for w, rows in found.items()},
                )
            )
            alike[s.unit, s.unit_type, s.stand] = parts[-1]
        hypotheses = {w: tuple(table) for w, table in numbers.items()}
        return cls(hypotheses, log_priors(hypotheses, list(known), level), tuple(parts))


def _places(
    s: SessionStatistics, wide: bool
) -> tuple[list[tuple[GroupHypothesis, Array]], tuple[tuple[int, ...], ...]]:
    """Every hypothesis that a session speaks of with its columns there, and the sums that further columns are."""
    found: list[tuple[GroupHypothesis, Array]] = []
    together: dict[tuple[str, str, float | None], list[int]] = {}
    for b, start in zip(s.blocks, s.starts, strict=False):
        columns = start + np.arange(b.width)
        level, subject = (UNIT, s.unit) if b.sensor else (STAND, s.stand)
        found.append((GroupHypothesis(level, subject, b.cause, b.sensor, b.kind, b.shape, b.width), columns))
        if wide and b.sensor and b.cause != HARMONIC:
            if s.unit_type:
                found.append((GroupHypothesis(TYPE, s.unit_type, b.cause, b.sensor, b.kind, b.shape, b.width), columns))
            if b.width == 1:
                together.setdefault((b.cause, b.kind, b.shape), []).append(int(start))
    sums: list[tuple[int, ...]] = []
    D = len(s.size)
    for (cause, kind, shape), members in together.items():
        columns = np.array([D + len(sums)])
        sums.append(tuple(members))
        for level, subject in ((TYPE, s.unit_type), (STAND, s.stand)):
            if subject:
                found.append((GroupHypothesis(level, subject, cause, EVERY, kind, shape, 1), columns))
    return found, tuple(sums)


def log_priors(
    hypotheses: dict[int, tuple[GroupHypothesis, ...]], known: list[GroupHypothesis], level: str
) -> dict[int, Array]:
    """Width → (H,) ln of every hypothesis' prior share.

    The j-th subject of a level, in the order of arrival, has 1/(j·(j + 1)) of its share: what the next one gets is
    taken from none, so that the evidence of a growing group stays an e-value. Within a subject causes share evenly,
    then their places, then their shapes.
    """
    order: dict[tuple[str, str], int] = {}
    places: dict[tuple[str, str, str, bool], set[tuple[str, str]]] = {}
    shapes: dict[tuple[str, ...], int] = {}
    for h in known:
        seen = sum(k[0] == h.level for k in order)
        order.setdefault((h.level, h.subject), seen + 1)
        places.setdefault((h.level, h.subject, h.cause, h.sensor == EVERY), set()).add((h.sensor, h.kind))
        shapes[h.group] = shapes.get(h.group, 0) + 1
    causes = len(lasting_causes())

    def log_prior(h: GroupHypothesis) -> float:
        if h.nameless:
            return -np.inf
        j = order[h.level, h.subject]
        share = SHARES[level][h.level] / (j * (j + 1)) / causes
        if level != UNIT and h.sensor:
            share *= SHARED if h.sensor == EVERY else 1 - SHARED
        return float(np.log(share / len(places[h.level, h.subject, h.cause, h.sensor == EVERY]) / shapes[h.group]))

    return {w: np.array([log_prior(h) for h in table]) for w, table in hypotheses.items()}
