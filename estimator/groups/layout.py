"""Hypotheses of a group: which columns of which sessions share one amplitude.

A sensor cause may be one unit's (its sensor), a type's (the sensor of that name in every unit, or every sensor of a
kind) or a stand's (every sensor of a kind of every unit on it, while on it); a cause of stand or fixture is the
stand's. All of them are held against the same sessions, so that the level is chosen as the cause is. A hypothesis has
no columns in sessions that it does not speak of.
"""

from collections.abc import Iterable, Sequence

import numpy as np

from estimator.groups.candidates import lasting_causes
from estimator.groups.pool import Among, GroupHypothesis, Part, Pool
from estimator.groups.priors import OUTSIDE, SHARED, SHARES, STAND, TYPE, UNIT
from estimator.groups.scores import batch
from estimator.groups.statistics import HARMONIC, SessionStatistics
from estimator.session import Array

EVERY = "*"
"""Takes the place of a sensor's name: every sensor of the kind."""


def pool_of(sessions: Sequence[SessionStatistics], level: str) -> Pool:
    """The pool of sessions, oldest first, each in the scatter that those of its unit show together."""
    stated = pool_in(sessions, level, np.ones(len(sessions)))
    scale = larger_than_stated(stated, sessions)
    return stated if np.all(scale == 1) else pool_in(sessions, level, scale)


def pool_in(sessions: Sequence[SessionStatistics], level: str, scale: Array) -> Pool:
    """The pool of sessions, oldest first, whose variances are ``scale`` (n,) times as large as stated."""
    numbers: dict[int, dict[GroupHypothesis, int]] = {}
    laid: dict[tuple[object, ...], tuple[dict[int, Array], dict[int, Array], list[list[int]]]] = {}
    parts = []
    for s, factor in zip(sessions, scale.tolist(), strict=True):
        key = (s.unit, s.unit_type, s.stand, s.blocks)
        if key not in laid:
            placed, sums = _places(s, level != UNIT)
            found: dict[int, list[tuple[int, Array]]] = {}
            for h, columns in placed:
                table = numbers.setdefault(h.width, {})
                found.setdefault(h.width, []).append((table.setdefault(h, len(table)), columns))
            laid[key] = (
                {w: np.array([n for n, _ in rows]) for w, rows in found.items()},
                {w: np.array([c for _, c in rows]) for w, rows in found.items()},
                sums,
            )
        own, at, sums = laid[key]
        parts.append(Part(s.subjects, factor, *summed(s, sums, factor), own, at))
    hypotheses = {w: tuple(table) for w, table in numbers.items()}
    return Pool(hypotheses, log_priors(hypotheses, level), tuple(parts))


def summed(s: SessionStatistics, sums: Sequence[Sequence[int]], scale: float) -> tuple[Array, Array, Array, Among]:
    """Score, shrink and reach (E,), and information, of a session with sums over sensors, its variance ``scale`` times
    as large."""
    U = s.score * s.size / scale
    shrink = np.repeat(s.shrink, [b.width for b in s.blocks])
    if not sums:
        return U, shrink, s.reach, lambda rows, columns: s.among(rows, columns) * s.size[rows] * s.size[columns] / scale
    F = s.information * s.size[:, None] * s.size / scale
    add = np.zeros((len(sums), len(U)))
    for row, members in zip(add, sums, strict=True):
        row[members] = 1.0
    across = add @ F
    F = np.block([[F, across.T], [across, across @ add.T]])
    shrink = np.concatenate([shrink, [float(shrink[members].mean()) for members in sums]])
    reach = np.concatenate([s.reach, [float(s.reach[members].max()) for members in sums]])
    return np.concatenate([U, add @ U]), shrink, reach, lambda rows, columns: np.asarray(F[rows, columns])


def _places(s: SessionStatistics, wide: bool) -> tuple[list[tuple[GroupHypothesis, Array]], list[list[int]]]:
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
    for number, (cause, kind, shape) in enumerate(together):
        for level, subject in ((TYPE, s.unit_type), (STAND, s.stand)):
            if subject:
                h = GroupHypothesis(level, subject, cause, EVERY, kind, shape, 1)
                found.append((h, np.array([len(s.size) + number])))
    return found, list(together.values())


def log_priors(hypotheses: dict[int, tuple[GroupHypothesis, ...]], level: str) -> dict[int, Array]:
    """Width → (H,) ln of every hypothesis' prior share; of waves without a name in odds of them all.

    The j-th subject of a level, in the order of arrival, has 1/(j·(j + 1)) of its share: what the next one gets is
    taken from none, so that the evidence of a growing group stays an e-value. Within a subject causes share evenly,
    then their places, then their shapes.
    """
    order: dict[tuple[str, str], int] = {}
    places: dict[tuple[str, str, str, bool], set[tuple[str, str]]] = {}
    shapes: dict[tuple[str, ...], int] = {}
    for h in (h for table in hypotheses.values() for h in table):
        seen = sum(k[0] == h.level for k in order)
        order.setdefault((h.level, h.subject), seen + 1)
        places.setdefault((h.level, h.subject, h.cause, h.sensor == EVERY), set()).add((h.sensor, h.kind))
        shapes[h.group] = shapes.get(h.group, 0) + 1
    causes, waves = len(lasting_causes()), sum(h.nameless for table in hypotheses.values() for h in table)

    def share(h: GroupHypothesis) -> float:
        if h.nameless:
            return OUTSIDE / waves
        j = order[h.level, h.subject]
        whole = SHARES[level][h.level] / (j * (j + 1)) / causes
        if level != UNIT and h.sensor:
            whole *= SHARED if h.sensor == EVERY else 1 - SHARED
        return whole / len(places[h.level, h.subject, h.cause, h.sensor == EVERY]) / shapes[h.group]

    with np.errstate(divide="ignore"):
        return {w: np.log(np.array([share(h) for h in table])) for w, table in hypotheses.items()}


def larger_than_stated(pool: Pool, sessions: Sequence[SessionStatistics]) -> Array:
    """(n,) at least 1: by how much the sessions of each unit scatter more than they say, over all of them.

    Those that were corrected by themselves are asked apart. The largest effect of the unit is no scatter.
    """
    energy: dict[tuple[str, bool], Array] = {}
    for s in sessions:
        sums = energy.setdefault(_believed(s), np.zeros(2))
        sums += [s.energy.sum(), s.freedom.sum()]
    most = dict.fromkeys((unit for unit, _ in energy), 0.0)
    for w, m in pool.given().moments.items():
        for h, t in zip(pool.hypotheses[w], batch(m.U.sum(axis=0), m.F.sum(axis=0))[0].tolist(), strict=True):
            for unit in _of(h, most):
                most[unit] = max(most[unit], t if h.level == UNIT else t / len(most))
    freedom = {u: sum(f for (v, _), (_, f) in energy.items() if v == u) for u in most}
    factor = {
        key: max(1.0, float((e - most[key[0]] * f / max(freedom[key[0]], 1.0)) / max(f, 1.0)))
        for key, (e, f) in energy.items()
    }
    return np.array([factor[_believed(s)] for s in sessions])


def _of(h: GroupHypothesis, units: Iterable[str]) -> list[str]:
    """The units whose scatter may be an effect: its own, of a stand all of them, of a type none."""
    return [u for u in units if (u == h.subject and h.level == UNIT) or h.level == STAND]


def _believed(s: SessionStatistics) -> tuple[str, bool]:
    """The unit of a session, and whether its noise was taken as stated."""
    return s.unit, bool(np.all(s.noise_factor == 1))
