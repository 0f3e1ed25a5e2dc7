"""Hidden cases: a session file, its history, and the truth that the examined function does not see."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tests.blind.catalogue import CATALOGUE, DISCRETE, HISTORY, SENSOR
from tests.blind.draw import draw_earlier, draw_session
from tests.blind.effects_outside import OUTSIDE_INPUT, OUTSIDE_NEEDS, OUTSIDE_POSE
from tests.blind.hide import UnhideableError, at_strength, draw_effect, scaled, signature, strength_of
from tests.blind.physics import measure
from tests.blind.pose import gravity
from tests.blind.rivals import available
from tests.blind.separation import Field, Rival
from tests.blind.strength import Lens, history_information, nominal_information, root
from tests.blind.world import Effect, Session
from tests.blind.write import session_file

WEAKEST, STRONGEST = 8.0, 40.0
FAINTEST = 2.0
"""Weak cases, for the detection curve only, reach down to here."""
ENTRY_FACTOR = 3.0
"""Errors of the record that only the nominal axes show are drawn so much stronger: the maker's tolerance is vague."""
PASSING = ("bias-jump", "reading-outlier")
"""Effects of one sensor that belong to one session."""
TRIES = 60
BLIND = 0.03
"""Below this share of the best seen direction a combination of amplitudes is taken as unseen."""


@dataclass(frozen=True)
class Truth:
    """One hidden effect as scoring needs it."""

    effect: Effect
    names: tuple[str, ...]
    """Of the sensors."""
    strength: float
    nearest: Rival | None
    """The closest rival; None when there is none."""
    comparable: bool = True
    """Whether the session sees every one of several amplitudes."""

    @property
    def separation(self) -> float:
        """Standard errors of a reading to the nearest rival."""
        return np.inf if self.nearest is None else self.nearest.left


@dataclass(frozen=True)
class Case:
    """What is given to the diagnosis, and the truth."""

    label: str
    kind: str
    """single, weak, none, outside, two."""
    session: dict[str, Any]
    history: list[dict[str, Any]]
    truths: tuple[Truth, ...]
    world: Session


def draw_case(kind: str, seed: tuple[int, ...], cause: str | None = None) -> Case:
    """A case of a kind from a seed; drawn anew until the session can hold the effect."""
    for attempt in range(TRIES):
        rng = np.random.default_rng([*seed, attempt])
        try:
            return KINDS[kind]("-".join(map(str, seed)), rng, cause)
        except UnhideableError:
            continue
    raise UnhideableError(f"{kind} {cause} {seed}")


def draw_target(rng: np.random.Generator, between: tuple[float, float] = (WEAKEST * 1.01, STRONGEST)) -> float:
    """Strength, log-uniform."""
    return float(np.exp(rng.uniform(*np.log(between))))


def _none(label: str, rng: np.random.Generator, cause: str | None) -> Case:
    session = draw_session(rng)
    earlier = [draw_earlier(session, rng) for _ in range(rng.integers(1, 4))] if rng.random() < 0.5 else []
    return _written(label, "none", session, earlier, (), (), rng)


def _single(label: str, rng: np.random.Generator, cause: str | None) -> Case:
    return _hidden(label, "single", rng, cause, (WEAKEST * 1.01, STRONGEST))


def _weak(label: str, rng: np.random.Generator, cause: str | None) -> Case:
    return _hidden(label, "weak", rng, cause, (FAINTEST, WEAKEST))


def _hidden(label: str, kind: str, rng: np.random.Generator, cause: str | None, strengths: tuple[float, float]) -> Case:
    cause = cause or str(rng.choice(list(CATALOGUE)))
    hidden = CATALOGUE[cause]
    session = draw_session(rng, hidden.needs)
    if not available(session, cause):
        raise UnhideableError(cause)
    between = hidden.scope == HISTORY
    with_history = "history" in hidden.needs or rng.random() < 0.4
    earlier = [draw_earlier(session, rng) for _ in range(rng.integers(1, 4))] if with_history else []
    lens = Lens(session, root(_outside_information(session, earlier)) if between else None)
    vague = ENTRY_FACTOR if between and not earlier else 1.0
    effect, strength = at_strength(lens, draw_effect(session, cause, rng), vague * draw_target(rng, strengths))
    if strength < strengths[0]:
        raise UnhideableError(cause)
    truth = _truth(Field(lens, between), session, effect, strength)
    lasting = hidden.scope == SENSOR and cause not in PASSING and rng.random() < 0.5
    return _written(label, kind, session, earlier, (effect,), (truth,), rng, lasting=lasting)


def _outside_information(session: Session, earlier: list[Session]) -> np.ndarray:
    return history_information(earlier) if earlier else nominal_information(session)


def _truth(field: Field, session: Session, effect: Effect, strength: float) -> Truth:
    names = tuple(session.unit.names[i] for i in effect.sensors)
    if effect.cause == "excess-noise":
        return Truth(effect, names, strength, None)
    left = field.lens.left(signature(session, effect).reshape(-1, 1))[:, 0]
    own = (
        sum(k != 0 for k in effect.amplitude) if effect.cause == "sensor-drift" else CATALOGUE[effect.cause].parameters
    )
    rivals = field.rivals(left, effect.cause, effect.sensors, own)
    comparable = len(effect.amplitude) < 2 or _all_seen(field.lens.left(_columns(session, effect)))
    return Truth(effect, names, strength, rivals[0] if rivals else None, comparable)


def _all_seen(left: np.ndarray) -> bool:
    """Whether no direction of the amplitudes is close to unseen."""
    values = np.linalg.svd(left, compute_uv=False)
    return bool(values[-1] > BLIND * values[0])


def _two(label: str, rng: np.random.Generator, cause: str | None) -> Case:
    within = [name for name, hidden in CATALOGUE.items() if hidden.scope != HISTORY]
    pair = [str(name) for name in rng.choice(within, 2, replace=False)]
    session = draw_session(rng, frozenset().union(*(CATALOGUE[name].needs for name in pair)))
    if not all(available(session, name) for name in pair):
        raise UnhideableError(str(pair))
    lens = Lens(session)
    drawn = [at_strength(lens, draw_effect(session, name, rng), 2 * WEAKEST)[0] for name in pair]
    effects, truths = list(drawn), []
    for k in (0, 1):
        apart = lens.without(_columns(session, effects[1 - k]))
        effects[k], _ = at_strength(apart, effects[k], draw_target(rng))
    for k in (0, 1):
        apart = lens.without(_columns(session, effects[1 - k]))
        strength = strength_of(apart, effects[k])
        if strength < WEAKEST:
            raise UnhideableError(str(pair))
        truths.append(_truth(Field(apart, between=False), session, effects[k], strength))
    return _written(label, "two", session, [], tuple(effects), tuple(truths), rng)


def _columns(session: Session, effect: Effect) -> np.ndarray:
    """(R·m, p) what the fit of an effect could take away."""
    if effect.cause == "excess-noise":
        return np.zeros((session.schedule.rows * session.unit.size, 1))
    if effect.cause in DISCRETE or effect.cause == "saturation":
        return signature(session, effect).reshape(-1, 1)
    size = max(abs(k) for k in effect.amplitude)
    single = [replace(effect, amplitude=tuple(size * row)) for row in np.eye(len(effect.amplitude))]
    return np.stack([signature(session, e).ravel() for e in single], axis=1)


def _outside(label: str, rng: np.random.Generator, cause: str | None) -> Case:
    cause = cause or str(rng.choice([*OUTSIDE_INPUT, *OUTSIDE_POSE]))
    needs = OUTSIDE_NEEDS.get(cause, frozenset())
    session = draw_session(rng, needs)
    lens = Lens(session)
    field = Field(lens, between=False)
    sensors = (int(rng.integers(session.unit.size)),) if cause in OUTSIDE_INPUT else ()
    size = 1e-5 if not sensors or not session.unit.gyro[sensors[0]] else 1e-8
    start = Effect(cause, (size,), sensors, (float(rng.uniform(0, 2 * np.pi)),))

    def unexplained(effect: Effect) -> float:
        return _nearest(field, session, effect).left

    effect, left = scaled(start, session, unexplained, draw_target(rng))
    if left < WEAKEST:
        raise UnhideableError(cause)
    names = tuple(session.unit.names[i] for i in sensors)
    truth = Truth(effect, names, strength_of(lens, effect), _nearest(field, session, effect))
    return _written(label, "outside", session, [], (effect,), (truth,), rng)


def _nearest(field: Field, session: Session, effect: Effect) -> Rival:
    left = field.lens.left(signature(session, effect).reshape(-1, 1))[:, 0]
    return field.rivals(left, effect.cause, effect.sensors, None)[0]


def _written(
    label: str,
    kind: str,
    session: Session,
    earlier: list[Session],
    effects: tuple[Effect, ...],
    truths: tuple[Truth, ...],
    rng: np.random.Generator,
    lasting: bool = False,
) -> Case:
    """Measured and put into files; an effect that lasts is in the earlier sessions too."""
    entry = [effect.k for effect in effects if effect.cause == "gravity-entry"]
    files = []
    for past in sorted(earlier, key=lambda p: p.started_at):
        if entry:
            past = replace(past, site=replace(past.site, gravity=gravity(session.site) * (1 + entry[0])))
        files.append(session_file(past, measure(past, effects if lasting else (), rng)[0]))
    readings = measure(session, effects, rng)[0]
    return Case(label, kind, session_file(session, readings), files, truths, session)


KINDS = {"none": _none, "single": _single, "weak": _weak, "two": _two, "outside": _outside}
