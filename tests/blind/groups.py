"""Groups of sessions drawn at random, with effects too small for one session: of a unit, a type, a stand."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tests.blind.catalogue import CATALOGUE, SENSOR, TANGENT
from tests.blind.draw import _misaligned, draw_earlier, draw_session, draw_stand
from tests.blind.effects_grammar import GRAMMAR, told_of
from tests.blind.effects_outside import OUTSIDE_INPUT, OUTSIDE_POSE
from tests.blind.group_separation import pooled_separation
from tests.blind.hide import UnhideableError, draw_effect, sensible, strength_of
from tests.blind.physics import measure
from tests.blind.rivals import available
from tests.blind.strength import Lens
from tests.blind.world import Array, Effect, Session, Unit
from tests.blind.write import session_file

OF_SENSOR = (
    "cubic-nonlinearity",
    "scale-asymmetry",
    "cross-coupling",
    "bias-temperature",
    "scale-temperature",
    "bias-ramp",
    "warm-up",
    "hysteresis",
    "odd-quadratic",
    "bias-asymmetry",
    "cross-axis-quadratic",
    "scale-ramp",
    "axis-creep",
    "bias-per-position",
    "thermal-lag",
)
OF_STAND = (
    "beta-eccentricity",
    "beta-second-harmonic",
    "beta-scale",
    "axis-wobble",
    "levelling-y",
    "alpha-shift",
    "flip-misalignment",
    "stand-drift",
)
BEYOND = ("third-harmonic", "fifth-harmonic", "turning-scale", "encoder-third-harmonic", "bearing-second-harmonic")
"""Effects outside the catalogue that are the same in every session, whatever its schedule."""
SAME, SPREAD, SINCE = "same", "spread", "since"
OUTSIDE, OF_GRAMMAR = "outside", "grammar"
LONGEST = 14
TRIES = 60


@dataclass(frozen=True)
class GroupTruth:
    """One lasting effect."""

    effect: Effect
    level: str
    subject: str
    names: tuple[str, ...]
    form: str
    since: int
    strengths: tuple[float, ...]
    """Strength in every session, standard errors; 0 where it does not act."""
    separation: float
    """Separation from the nearest other cause or level, on the pool."""
    spread: float
    """Spread of the amplitude between sessions, relative."""

    @property
    def pooled(self) -> float:
        """Standard errors of a reading."""
        return float(np.linalg.norm(self.strengths))


@dataclass(frozen=True, eq=False)
class Group:
    """Files that are given away, and the truth."""

    label: str
    level: str
    kind: str
    sessions: list[dict[str, Any]]
    truths: tuple[GroupTruth, ...]
    worlds: list[Session]
    effects: list[list[Effect]]
    """Effects in every session."""


def draw_group(
    level: str,
    kind: str,
    seed: tuple[int, ...],
    *,
    form: str = SAME,
    size: int | None = None,
    misstated: bool = False,
    quiet: bool = False,
) -> Group:
    """A group from a seed, drawn anew until it can hold its effects.

    ``kind``: none, one, two, outside, grammar, or the name of an effect of the grammar.
    ``quiet``: no session shows an effect by itself.
    """
    for attempt in range(TRIES):
        rng = np.random.default_rng([*seed, attempt])
        try:
            worlds = draw_worlds(level, rng, size)
            truths = draw_truths(level, kind, form, worlds, rng, quiet)
        except UnhideableError:
            continue
        return _measured("-".join(map(str, seed)), level, kind, worlds, truths, rng, misstated)
    raise UnhideableError(f"{level} {kind} {seed}")


def _measured(
    label: str, level: str, kind: str, worlds: list[Session], truths: tuple[GroupTruth, ...], rng: Any, misstated: bool
) -> Group:
    acting = [[scaled_in(t, k) for t in truths if t.strengths[k] > 0] for k in range(len(worlds))]
    factor = float(np.exp(rng.uniform(np.log(0.4), np.log(2.0)))) if misstated else 1.0
    files = []
    for world, effects in zip(worlds, acting, strict=True):
        document = session_file(world, measure(world, effects, rng)[0])
        document["unit_type"] = "BT"
        if misstated:
            for name in world.unit.names:
                if f"{name}_se" in document["table"]:
                    document["table"][f"{name}_se"] = [factor * x for x in document["table"][f"{name}_se"]]
            for sensor in document["sensors"]:
                for key in ("bias_repeatability_m_s2", "bias_repeatability_rad_s"):
                    if key in sensor:
                        sensor[key] *= factor
        files.append(document)
    return Group(label, level, kind, files, truths, worlds, acting)


def scaled_in(truth: GroupTruth, session: int) -> Effect:
    """The effect as it is in one session."""
    if not truth.spread:
        return truth.effect
    rng = np.random.default_rng([int(1e6 * truth.spread), session, len(truth.strengths)])
    factor = 1 + truth.spread * rng.standard_normal()
    return replace(truth.effect, amplitude=tuple(factor * k for k in truth.effect.amplitude))


def draw_worlds(level: str, rng: np.random.Generator, size: int | None) -> list[Session]:
    """Sessions, oldest first: of one unit; of several units on a stand and elsewhere; of several units of a type."""
    needs = frozenset({"time", "temperature"}) if rng.random() < 0.9 else frozenset()
    first = draw_session(rng, needs | {"both runs"}, LONGEST)
    if first.unit.size > 8:
        raise UnhideableError("too many sensors for a quick test")
    count = size or int(rng.integers(10, 19))
    home, other = first.stand, replace(draw_stand(first.site, rng), id="ODG-X")
    units = [first.unit] if level == "unit" else [_like(first.unit, k, rng) for k in range(int(rng.integers(3, 5)))]
    worlds = []
    for k in range(count):
        unit = units[k % len(units)]
        away = rng.random() < (0.25 if level != "type" else 0.5)
        session = draw_earlier(replace(first, unit=unit), rng, LONGEST)
        if not session.schedule.both_runs:
            raise UnhideableError("one run")
        if rng.random() < 0.1:
            session = replace(session, schedule=replace(session.schedule, thermometer=False))
        worlds.append(
            replace(
                session,
                stand=other if away else home,
                started_at=f"{2020 + k // 12}-{k % 12 + 1:02d}-03T09:00:00Z",
            )
        )
    return worlds


def _like(unit: Unit, number: int, rng: np.random.Generator) -> Unit:
    """Another unit of the same type."""
    m = unit.size
    return replace(
        unit,
        name=f"BU-{number}",
        axis=np.array([_misaligned(e, rng) for e in unit.nominal_axis]),
        scale=unit.nominal_scale * (1 + rng.uniform(-0.01, 0.01, m)),
        bias=unit.bias * rng.uniform(-1, 1, m),
        quadratic=unit.quadratic * rng.uniform(-1, 1, m),
    )


def draw_truths(
    level: str, kind: str, form: str, worlds: list[Session], rng: np.random.Generator, quiet: bool
) -> tuple[GroupTruth, ...]:
    """Draws none, one or two effects."""
    count = {"none": 0, "two": 2}.get(kind, 1)
    found: list[GroupTruth] = []
    for _ in range(count):
        if kind not in ("one", "two"):
            cause = str(rng.choice({OUTSIDE: BEYOND, OF_GRAMMAR: tuple(GRAMMAR)}.get(kind, (kind,))))
            found.append(draw_truth(level, cause, form, worlds, rng, target=6 * np.sqrt(len(worlds))))
            continue
        common = level == "stand" or (level == "unit" and rng.random() < 0.25)
        choice = [c for c in (OF_STAND if common else OF_SENSOR) if level != "type" or c not in TANGENT]
        cause = str(rng.choice([c for c in choice if c not in [t.effect.cause for t in found]]))
        target = float(rng.uniform(8.2, 9.5 if quiet else 13.0))
        found.append(draw_truth(level, cause, form, worlds, rng, target=target, loudest=3.5 if quiet else np.inf))
    return tuple(found)


def draw_truth(
    level: str,
    cause: str,
    form: str,
    worlds: list[Session],
    rng: np.random.Generator,
    *,
    target: float,
    loudest: float = np.inf,
) -> GroupTruth:
    """One effect of a pooled strength, at most ``loudest`` in a session."""
    first = worlds[0]
    outside = cause in (GRAMMAR | OUTSIDE_INPUT | OUTSIDE_POSE)
    common = cause in OF_STAND or cause in OUTSIDE_POSE
    if outside:
        effect = draw_outside(first, cause, common, rng)
    else:
        if not available(first, cause):
            raise UnhideableError(cause)
        effect = draw_effect(first, cause, rng)
    stand = max({w.stand.id for w in worlds}, key=[w.stand.id for w in worlds].count)
    since = int(rng.integers(2, len(worlds) // 2)) if form == SINCE else 0
    acts = [
        k >= since and (not common or w.stand.id == stand) and (outside or _shows(w, cause))
        for k, w in enumerate(worlds)
    ]
    lenses = [Lens(w) for w in worlds]
    each = np.array([strength_of(x, effect) if a else 0.0 for x, a in zip(lenses, acts, strict=True)])
    if not each.any():
        raise UnhideableError(cause)
    grown = target / np.linalg.norm(each)
    if (grown * each).max() > loudest:
        raise UnhideableError("a session shows it by itself")
    effect = replace(effect, amplitude=tuple(float(grown * k) for k in effect.amplitude))
    if not sensible(first, effect):
        raise UnhideableError(cause)
    whose = "stand" if common else "type" if level == "type" else "unit"
    subject = {"stand": stand, "type": "BT", "unit": first.unit.name}[whose]
    if whose == "unit" and level != "unit":
        raise UnhideableError("a unit's effect in a group of several")
    spread = float(rng.uniform(0.4, 0.8)) if form == SPREAD else 0.0
    unasked = outside and cause not in GRAMMAR
    apart = np.inf if unasked else pooled_separation(lenses, effect, [bool(a) for a in acts])
    strengths = grown * each
    if whose != "unit":
        apart = min(apart, _beyond_one_unit(worlds, strengths))
    names = tuple(first.unit.names[i] for i in effect.sensors)
    return GroupTruth(effect, whose, subject, names, form, since, tuple(strengths.tolist()), float(apart), spread)


def draw_outside(first: Session, cause: str, common: bool, rng: np.random.Generator) -> Effect:
    """An effect outside the catalogue, of any size, on a sensor or common to all."""
    if cause in GRAMMAR and not told_of(first, cause):
        raise UnhideableError(cause)
    sensors = () if common else (int(rng.integers(first.unit.size)),)
    size = 1e-5 if not sensors or not first.unit.gyro[sensors[0]] else 1e-8
    if cause in GRAMMAR:
        return Effect(cause, (size,), sensors, (float(np.exp(rng.uniform(np.log(300), np.log(3000)))),))
    return Effect(cause, (size,), sensors, (float(rng.uniform(0, 2 * np.pi)),))


def _shows(world: Session, cause: str) -> bool:
    """Whether the effect shows: it acts whatever the file holds, but a file without its variable cannot tell it."""
    return cause not in CATALOGUE or CATALOGUE[cause].scope != SENSOR or available(world, cause)


def _beyond_one_unit(worlds: list[Session], strengths: Array) -> float:
    """Strength in all units but the one that shows it most: what tells a type or stand from a unit."""
    square: dict[str, Array] = {}
    for w, s in zip(worlds, strengths, strict=True):
        square[w.unit.name] = square.get(w.unit.name, 0.0) + s**2
    return float(np.sqrt(sum(square.values()) - max(square.values())))
