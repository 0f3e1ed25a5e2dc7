"""Distance of a lasting effect from every other one on the sessions of a group, by the generator's own physics."""

from math import fsum
from typing import Any

import numpy as np

from tests.blind.catalogue import CATALOGUE, SENSOR
from tests.blind.effects_sensor import INPUT
from tests.blind.hide import signature
from tests.blind.physics import reference_vectors
from tests.blind.pose import believed
from tests.blind.rivals import _numerical, available
from tests.blind.strength import Lens
from tests.blind.world import Array, Effect, Session

PASSING = frozenset({"bias-jump", "reading-outlier", "saturation", "excess-noise", "positions-swapped"})
TIME_CONSTANTS = np.geomspace(60, 15000, 7)
DUST = 1e-4


def pooled_separation(lenses: list[Lens], effect: Effect, acts: list[bool]) -> float:
    """Standard errors: what the best fit of the nearest rival, of one amplitude in all sessions, leaves.

    Rivals with more amplitudes that contain the truth are spared, as parsimony does.
    """
    known = CATALOGUE.get(effect.cause)
    own = known.parameters if known else len(effect.amplitude)
    truth: list[Array] = []
    blocks: dict[Any, dict[int, Array]] = {}
    for lens, on in zip(lenses, acts, strict=True):
        left = lens.left(signature(lens.session, effect).reshape(-1, 1))[:, 0] if on else None
        truth.append(np.zeros(len(lens.whitened)) if left is None else left)
    for number, lens in enumerate(lenses):
        for key, columns in _columns(lens.session):
            if key[:2] != (effect.cause, effect.sensors):
                blocks.setdefault(key, {})[number] = columns
    best = np.inf
    for key, parts in blocks.items():
        unlike = _left(lenses, truth, parts)
        if known and CATALOGUE[key[0]].parameters > own and unlike < 2.0:
            continue
        best = min(best, unlike)
    return float(best)


def _left(lenses: list[Lens], truth: list[Array], parts: dict[int, Array]) -> float:
    """Norm of what one pooled fit leaves."""
    p = next(iter(parts.values())).shape[1]
    gram, moment, whole = np.zeros((p, p)), np.zeros(p), fsum(float(t @ t) for t in truth)
    for number, columns in parts.items():
        white = np.linalg.norm(lenses[number].whiten(columns), axis=0)
        left = lenses[number].left(columns)
        left = left * (np.linalg.norm(left, axis=0) > DUST * white)
        gram, moment = gram + left.T @ left, moment + left.T @ truth[number]
    size = np.sqrt(np.where(np.diagonal(gram) > 0, np.diagonal(gram), 1.0))
    inverse = np.linalg.pinv(gram / size[:, None] / size, rcond=1e-8, hermitian=True)
    return float(np.sqrt(max(whole - float((moment / size) @ inverse @ (moment / size)), 0.0)))


def _columns(session: Session):
    """Every lasting rival's columns (R·m, p), reading units per unit amplitude, in this session."""
    force, rate = reference_vectors(session, believed(session))
    R, m = session.schedule.rows, session.unit.size
    for cause, hidden in CATALOGUE.items():
        if cause in PASSING or not available(session, cause):
            continue
        if hidden.scope == SENSOR:
            grid = [(t,) for t in TIME_CONSTANTS] if cause in ("warm-up", "thermal-lag") else [()]
            for i in range(m):
                if cause == "vibration-rectification" and session.unit.gyro[i]:
                    continue
                n = rate if session.unit.gyro[i] else force
                a = n @ session.unit.axis[i]
                for shape in grid:
                    columns = np.zeros((R, m, hidden.size))
                    for k in range(hidden.size):
                        unit = Effect(cause, tuple(np.eye(hidden.size)[k]), (i,), shape)
                        columns[:, i, k] = session.unit.scale[i] * INPUT[cause](session, unit, n, a, force)
                    yield (cause, (i,), shape), columns.reshape(R * m, -1)
        elif cause in POSES:
            yield (
                (cause, (), ()),
                _numerical(session, cause, ())
                / (1e-5 / float(np.ptp(session.schedule.time)) if cause == "stand-drift" else 1e-5),
            )


POSES = frozenset(
    {
        "beta-eccentricity",
        "beta-second-harmonic",
        "beta-scale",
        "axis-wobble",
        "levelling-y",
        "alpha-shift",
        "flip-misalignment",
        "stand-drift",
        "meridian-error",
    }
)
