"""Training data of the network: sessions and effects of the study's generator, noise as fast as it is drawn.

A session is drawn, measured once, read and fitted as in a diagnosis. Effects in it are the generator's, each as the
difference that it makes to the readings, whitened and freed of what the baseline absorbs; residuals are these times a
size, and white noise freed of the same. Half the draws of every session are sound, so that a programme tells nothing
of whether there is an effect.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from benchmarks.study.neural.network import Design, design_of
from estimator import read_session
from estimator.calibration.calibrate import averaged
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array
from tests.blind.catalogue import CATALOGUE, SENSOR
from tests.blind.draw import draw_session
from tests.blind.hide import UnhideableError, draw_effect, sensible, signature
from tests.blind.physics import measure
from tests.blind.rivals import available
from tests.blind.world import Effect, Session
from tests.blind.write import session_file

STRENGTHS = (3.0, 12.0)
"""Log-uniform."""
TYPICAL = 6.0
EFFECTS = 8
"""Drawn in each session."""
INVISIBLE = 1e-3
"""Share of a signature that the baseline must leave."""
SIZES = ((44, 6), (72, 6), (72, 8), (44, 12))
"""Rows and sensors to which sessions are filled up with zeros, so that many stand in one array."""


class Lesson(NamedTuple):
    """A session and effects in it; of many, the arrays have a leading axis."""

    design: Design
    prior: Array
    """(k, p) rows of the basis that the baseline absorbs for the stand's constant errors."""
    free: Array
    """(m, R) degrees of freedom of every residual."""
    unstated: Array
    """(m,) 1 where the noise is estimated from the residuals."""
    traces: Array
    """(E, m, R) trace that each effect leaves at strength 1, standard errors."""
    labels: Array
    """(E,) numbers in `log_posterior`; 0 after the last effect."""
    surprise: Array
    """(E,) log loss of who knows only how often each is drawn."""


def lesson(rng: np.random.Generator, own: tuple[str, ...], shared: tuple[str, ...]) -> Lesson:
    """Draws a session that meets the needs of some cause, with effects; drawn anew where no effect shows."""
    session = draw_session(rng, CATALOGUE[str(rng.choice([*own, *shared]))].needs)
    read = read_session(session_file(session, measure(session, [], rng)[0]))
    residuals = WhitenedResiduals.of(baseline_of(averaged(read)))
    able = [cause for cause in (*own, *shared) if available(session, cause)]
    drawn = [effect(session, residuals, str(cause), rng) for cause in rng.permutation(able)[:EFFECTS]]
    seen = [found for found in drawn if found]
    if not seen:
        return lesson(rng, own, shared)
    R, m = residuals.baseline.residual.shape
    rows, sensors = next(size for size in SIZES if size[0] >= R and size[1] >= m)
    labels = [label(cause, sensor, sensors, own, shared) for cause, sensor, _ in seen]
    surprise = np.log([2.0 * len(able) * (m if sensor >= 0 else 1) for _, sensor, _ in seen])
    traces, free = np.stack([left for *_, left in seen]), residuals.row_freedom[: R * m].reshape(R, m).T
    prior, unstated = residuals.basis[R * m :], residuals.baseline.unstated
    whole = Lesson(design_of(residuals), prior, free, unstated, traces, np.array(labels), surprise)
    return filled(whole, rows, sensors)


Found = tuple[str, int, Array]
"""A cause, its sensor or −1, and what it leaves (m, R) at strength 1."""


def effect(session: Session, residuals: WhitenedResiduals, cause: str, rng: np.random.Generator) -> Found | None:
    """An effect of the cause; None where the session cannot hold it."""
    try:
        drawn = draw_effect(session, cause, rng)
    except UnhideableError:
        return None
    _, strength = traced(session, residuals, drawn)
    drawn = replace(drawn, amplitude=tuple(TYPICAL / max(strength, 1e-300) * k for k in drawn.amplitude))
    if not strength or not sensible(session, drawn):
        return None
    left, strength = traced(session, residuals, drawn)
    return (cause, drawn.sensor if CATALOGUE[cause].scope == SENSOR else -1, left / strength) if strength else None


def traced(session: Session, residuals: WhitenedResiduals, drawn: Effect) -> tuple[Array, float]:
    """(m, R) trace that an effect leaves, standard errors, and its strength; 0 where it is as good as absorbed."""
    column = (signature(session, drawn) / session.unit.scale)[..., None]
    left, (R, m) = residuals.trace(column)[:, 0], column.shape[:2]
    strength, whole = float(np.linalg.norm(left)), np.linalg.norm(residuals.whitened(column))
    return left[: R * m].reshape(R, m).T, strength if strength > INVISIBLE * whole else 0.0


def label(cause: str, sensor: int, m: int, own: tuple[str, ...], shared: tuple[str, ...]) -> int:
    """Number in `log_posterior` of a block of m sensors."""
    return 1 + (sensor * len(own) + own.index(cause) if sensor >= 0 else m * len(own) + shared.index(cause))


def filled(whole: Lesson, R: int, m: int) -> Lesson:
    """The lesson with zeros up to R rows and m sensors."""
    p, F = 5 * m + 3, whole.design.known.shape[-1]
    shapes = Design((m, R, F), (m, R, p), (m, R), (R,), (m, R), (m, R, 5), (m, R))
    design = Design(*(fill(x, shape) for x, shape in zip(whole.design, shapes, strict=True)))
    rest = ((3, p), (m, R), (m,), (EFFECTS, m, R), (EFFECTS,), (EFFECTS,))
    return Lesson(design, *(fill(x, shape) for x, shape in zip(whole[1:], rest, strict=True)))


def fill(x: Array, shape: tuple[int, ...]) -> Array:
    """Zeros after an array, all in single precision."""
    return np.pad(x, [(0, n - k) for n, k in zip(shape, x.shape, strict=True)]).astype(np.float32)


def draw(these: Lesson, n: int, rng: np.random.Generator) -> tuple[Design, Array, Array, Array]:
    """Designs of d sessions, n draws each of residuals (d, m, n, R), labels (d, n), and their log loss by the prior."""
    at, design = np.arange(len(these.labels))[:, None], these.design
    which = (rng.random((len(at), n)) * (these.labels > 0).sum(axis=1)[:, None]).astype(int)
    acts = rng.choice([-1, 0, 0, 1], which.shape)
    size = acts * np.exp(rng.uniform(np.log(STRENGTHS[0]), np.log(STRENGTHS[1]), acts.shape))
    white = rng.standard_normal((*design.present.shape[:2], n, design.present.shape[2]), dtype=np.float32)
    white *= design.present[:, :, None]
    constant = rng.standard_normal((len(at), n, these.prior.shape[1]), dtype=np.float32) @ these.prior
    inside = (white @ design.basis).sum(axis=1) + constant
    effects = (these.traces[at, which] * size[..., None, None]).swapaxes(1, 2)
    z = white - inside[:, None] @ design.basis.swapaxes(-1, -2) + effects
    scale = np.sqrt(these.free.sum(axis=2)[:, :, None] / np.maximum((z**2).sum(axis=3), 1e-6))
    z *= np.where(these.unstated[:, :, None] > 0, scale, 1.0)[..., None]
    labels = np.where(acts, these.labels[at, which], 0).astype(int)
    return design, z.astype(np.float32), labels, np.where(acts, these.surprise[at, which], np.log(2))
