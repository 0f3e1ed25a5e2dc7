"""Cases drawn at random: one effect, a weak one, none, one outside the catalogue, two at once."""

import numpy as np

from tests.blind.case import Case, Draw, Truth, effect_columns, history_files, truth_of, written
from tests.blind.catalogue import CATALOGUE, HISTORY, SENSOR
from tests.blind.draw import draw_earlier, draw_session
from tests.blind.effects_outside import OUTSIDE_INPUT, OUTSIDE_NEEDS, OUTSIDE_POSE
from tests.blind.hide import UnhideableError, at_strength, draw_effect, scaled, signature, strength_of
from tests.blind.physics import measure
from tests.blind.rivals import available
from tests.blind.separation import Field, Rival
from tests.blind.strength import Lens, history_information, nominal_information, root
from tests.blind.world import Effect, Session

WEAKEST, STRONGEST = 8.0, 40.0
FAINTEST = 2.0
"""Weak cases, for the detection curve only, reach down to here."""
ENTRY_FACTOR = 3.0
"""Errors of the record that only the nominal axes show are drawn so much stronger: the maker's tolerance is vague."""
LEFT_OUT = "left out"
PASSING = ("bias-jump", "reading-outlier")
"""Effects of one sensor that belong to one session."""
TRIES = 80
LONGEST = 36


def draw_case(kind: str, seed: tuple[int, ...], cause: str | None = None, longest: int = LONGEST) -> Case:
    """A case of a kind from a seed, at most ``longest`` positions a run; drawn anew until it can hold the effect."""
    for attempt in range(TRIES):
        draw = Draw("-".join(map(str, seed)), np.random.default_rng([*seed, attempt]), longest)
        try:
            return KINDS[kind](draw, cause)
        except UnhideableError:
            continue
    raise UnhideableError(f"{kind} {cause} {seed}")


def draw_at(strength: float, seed: tuple[int, ...], cause: str, longest: int = LONGEST) -> Case:
    """A case of one effect of one strength, without other sessions."""
    for attempt in range(TRIES):
        draw = Draw("-".join(map(str, seed)), np.random.default_rng([*seed, attempt]), longest)
        try:
            return _hidden(draw, "weak", cause, (0.99 * strength, 1.01 * strength), alone=True)
        except UnhideableError:
            continue
    raise UnhideableError(f"{strength} {cause} {seed}")


def draw_target(rng: np.random.Generator, between: tuple[float, float] = (WEAKEST * 1.01, STRONGEST)) -> float:
    """Strength, log-uniform."""
    return float(np.exp(rng.uniform(*np.log(between))))


def _history(draw: Draw, session: Session, chance: float) -> list[Session]:
    """One to three earlier sessions, or none."""
    if draw.rng.random() >= chance:
        return []
    return [draw_earlier(session, draw.rng, draw.longest) for _ in range(draw.rng.integers(1, 4))]


def _session(draw: Draw, needs: frozenset[str], causes: list[str]) -> Session:
    """A session that holds what the causes need."""
    session = draw_session(draw.rng, needs, draw.longest)
    if not all(available(session, cause) for cause in causes):
        raise UnhideableError(str(causes))
    return session


def _none(draw: Draw, cause: str | None) -> Case:
    session = draw_session(draw.rng, frozenset(), draw.longest)
    history = history_files(draw, session, _history(draw, session, 0.5), (), lasting=False)
    return written(draw, "none", session, measure(session, [], draw.rng)[0], (), history)


def _single(draw: Draw, cause: str | None) -> Case:
    return _hidden(draw, "single", cause, (WEAKEST * 1.01, STRONGEST))


def _weak(draw: Draw, cause: str | None) -> Case:
    return _hidden(draw, "weak", cause, (FAINTEST, WEAKEST))


def _twelve(draw: Draw, cause: str | None) -> Case:
    """One effect of one strength, for the study of what the noise is stated as."""
    return _hidden(draw, "single", cause, (11.9, 12.1))


def _left_out(draw: Draw, cause: str | None) -> Case:
    """A strong effect, to be looked for with a catalogue that lacks it: every other explanation is its rival."""
    return _hidden(draw, LEFT_OUT, cause, (0.99 * STRONGEST, STRONGEST))


def _hidden(draw: Draw, kind: str, cause: str | None, strengths: tuple[float, float], *, alone: bool = False) -> Case:
    rng = draw.rng
    cause = cause or str(rng.choice(list(CATALOGUE)))
    hidden = CATALOGUE[cause]
    session = _session(draw, hidden.needs, [cause])
    between = hidden.scope == HISTORY
    earlier = [] if alone else _history(draw, session, 1.0 if "history" in hidden.needs else 0.4)
    lens = Lens(session, _outside_root(session, earlier) if between else None)
    vague = ENTRY_FACTOR if between and not earlier else 1.0
    effect, strength = at_strength(lens, draw_effect(session, cause, rng), vague * draw_target(rng, strengths))
    if strength < strengths[0]:
        raise UnhideableError(cause)
    readings = measure(session, [effect], rng)[0]
    truth = truth_of(Field(lens, between), effect, strength, readings, known=kind != LEFT_OUT)
    lasting = hidden.scope == SENSOR and cause not in PASSING and rng.random() < 0.5
    history = history_files(draw, session, earlier, (effect,), lasting)
    return written(draw, kind, session, readings, (truth,), history)


def _outside_root(session: Session, earlier: list[Session]) -> np.ndarray:
    """Root of the information on the parameters, from other sessions or else from the maker."""
    return root(history_information(earlier) if earlier else nominal_information(session))


def _two(draw: Draw, cause: str | None) -> Case:
    rng = draw.rng
    within = [name for name, hidden in CATALOGUE.items() if hidden.scope != HISTORY]
    pair = [str(name) for name in rng.choice(within, 2, replace=False)]
    session = _session(draw, frozenset().union(*(CATALOGUE[name].needs for name in pair)), pair)
    lens = Lens(session)
    effects = [at_strength(lens, draw_effect(session, name, rng), 2 * WEAKEST)[0] for name in pair]
    for k in (0, 1):
        apart = lens.without(effect_columns(session, effects[1 - k]))
        effects[k], _ = at_strength(apart, effects[k], draw_target(rng))
    readings = measure(session, effects, rng)[0]
    truths = tuple(_beside(lens, effects[k], effects[1 - k], readings) for k in (0, 1))
    return written(draw, "two", session, readings, truths)


def _beside(lens: Lens, effect: Effect, other: Effect, readings: np.ndarray) -> Truth:
    """The truth of an effect with another one fitted beside it."""
    apart = lens.without(effect_columns(lens.session, other))
    strength = strength_of(apart, effect)
    if strength < WEAKEST:
        raise UnhideableError(effect.cause)
    return truth_of(Field(apart, between=False), effect, strength, readings)


def _outside(draw: Draw, cause: str | None) -> Case:
    rng = draw.rng
    cause = cause or str(rng.choice([*OUTSIDE_INPUT, *OUTSIDE_POSE]))
    session = draw_session(rng, OUTSIDE_NEEDS.get(cause, frozenset()), draw.longest)
    lens = Lens(session)
    field = Field(lens, between=False)
    sensors = (int(rng.integers(session.unit.size)),) if cause in OUTSIDE_INPUT else ()
    size = 1e-5 if not sensors or not session.unit.gyro[sensors[0]] else 1e-8
    start = Effect(cause, (size,), sensors, (float(rng.uniform(0, 2 * np.pi)),))
    effect, left = scaled(start, session, lambda e: _nearest(field, session, e).left, draw_target(rng))
    if left < WEAKEST:
        raise UnhideableError(cause)
    names = tuple(session.unit.names[i] for i in sensors)
    truth = Truth(effect, names, strength_of(lens, effect), _nearest(field, session, effect))
    return written(draw, "outside", session, measure(session, [effect], rng)[0], (truth,))


def _nearest(field: Field, session: Session, effect: Effect) -> Rival:
    left = field.lens.left(signature(session, effect).reshape(-1, 1))[:, 0]
    return field.rivals(left, effect.cause, effect.sensors, None)[0]


KINDS = {
    "none": _none,
    "single": _single,
    "weak": _weak,
    "two": _two,
    "outside": _outside,
    LEFT_OUT: _left_out,
    "twelve": _twelve,
}
