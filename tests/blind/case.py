"""A hidden case: what is given to the diagnosis, and the truth; and the truth's strength and separation."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tests.blind.catalogue import CATALOGUE, DISCRETE
from tests.blind.hide import signature
from tests.blind.physics import mean_readings, measure
from tests.blind.pose import gravity
from tests.blind.separation import Field, Rival
from tests.blind.world import Array, Effect, Session
from tests.blind.write import session_file

BLIND = 0.03
"""Below this share of the best seen direction a combination of amplitudes is taken as unseen."""


@dataclass(frozen=True)
class Truth:
    """One hidden effect as scoring needs it."""

    effect: Effect
    names: tuple[str, ...]
    """Names of the sensors."""
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
    """Files that the diagnosis is given, and the truth."""

    label: str
    kind: str
    """single, weak, none, outside, two, left out."""
    session: dict[str, Any]
    history: list[dict[str, Any]]
    truths: tuple[Truth, ...]
    world: Session


@dataclass(frozen=True, eq=False)
class Draw:
    """Settings with which a case is drawn."""

    label: str
    rng: np.random.Generator
    longest: int
    """Most positions of a run."""


def truth_of(field: Field, effect: Effect, strength: float, readings: Array, *, known: bool = True) -> Truth:
    """The truth with its nearest rival among the field's explanations; readings (R, m), reading units.

    Of a cause that is not ``known``, left out of the catalogue, parsimony spares no rival, and it is none itself.
    """
    session = field.lens.session
    names = tuple(session.unit.names[i] for i in effect.sensors)
    if effect.cause == "excess-noise":
        noise = field.lens.left((readings - mean_readings(session)).reshape(-1, 1))[:, 0]
        return Truth(effect, names, strength, field.nearest_to_noise(effect, noise))
    left = field.lens.left(signature(session, effect).reshape(-1, 1))[:, 0]
    rivals = field.rivals(left, effect.cause, effect.sensors, parameters_of(effect) if known else None)
    rivals = [rival for rival in rivals if known or rival.cause != effect.cause]
    comparable = len(effect.amplitude) < 2 or _all_seen(field.lens.left(effect_columns(session, effect)))
    return Truth(effect, names, strength, rivals[0] if rivals else None, comparable)


def parameters_of(effect: Effect) -> int:
    """Number of parameters that parsimony counts: for a drift those that moved, else as in the catalogue."""
    if effect.cause == "sensor-drift":
        return sum(k != 0 for k in effect.amplitude)
    return CATALOGUE[effect.cause].parameters


def _all_seen(left: Array) -> bool:
    """Whether no direction of the amplitudes is close to unseen."""
    values = np.linalg.svd(left, compute_uv=False)
    return bool(values[-1] > BLIND * values[0])


def effect_columns(session: Session, effect: Effect) -> Array:
    """(R·m, p) columns that the fit of an effect could take away, reading units."""
    if effect.cause == "excess-noise":
        return np.zeros((session.schedule.rows * session.unit.size, 1))
    if effect.cause in DISCRETE or effect.cause == "saturation":
        return signature(session, effect).reshape(-1, 1)
    size = max(abs(k) for k in effect.amplitude)
    single = [replace(effect, amplitude=tuple(size * row)) for row in np.eye(len(effect.amplitude))]
    return np.stack([signature(session, e).ravel() for e in single], axis=1)


def history_files(
    draw: Draw, session: Session, earlier: list[Session], effects: tuple[Effect, ...], lasting: bool
) -> list[dict[str, Any]]:
    """Earlier sessions measured, oldest first; an effect that lasts is in them too, a wrong entry of g is not."""
    entry = [effect.k for effect in effects if effect.cause == "gravity-entry"]
    files = []
    for past in sorted(earlier, key=lambda p: p.started_at):
        if entry:
            past = replace(past, site=replace(past.site, gravity=gravity(session.site) * (1 + entry[0])))
        files.append(session_file(past, measure(past, effects if lasting else (), draw.rng)[0]))
    return files


def written(
    draw: Draw,
    kind: str,
    session: Session,
    readings: Array,
    truths: tuple[Truth, ...] = (),
    history: list[dict[str, Any]] | None = None,
) -> Case:
    """The case in the form in which it is given away; readings (R, m), reading units."""
    return Case(draw.label, kind, session_file(session, readings), history or [], truths, session)
