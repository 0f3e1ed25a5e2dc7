"""Candidates that can last from session to session: every (cause, place, shape) and its columns in a session.

Amplitudes are physical constants in the catalogue's signs and units, so that those of different sessions may be added:
the phase of an eccentricity belongs to the encoder's zero, a coefficient to its sensor. What passes with its session
(an outlier, a jump, a clipped reading, a slip of the record) is no candidate. Shapes with a time constant are taken on
one grid for all sessions, not on each one's own.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from estimator.causes.catalogue import CATALOGUE
from estimator.causes.contract import Cause, CommonCause, SensorCause, Setting, Signature, on_sensor
from estimator.causes.stand import harmonic
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.groups.statistics import HARMONIC, Block
from estimator.session import Array

TIME_CONSTANTS = (60.0, 180.0, 540.0, 1620.0, 4860.0, 14580.0)
"""s: a minute to four hours, each three times the one before. Between two of them an exponential keeps 0.97 of its
strength, and every further one would cost every session's record a column a sensor."""

TANGENTIAL = frozenset({"cross-coupling", "axis-creep", "cross-axis-quadratic"})
"""Causes with one amplitude along each of two tangents of the axis. The tangents are those of the nominal axis: those
of the fitted one may change places where two of its components are equal."""

HARMONICS = range(2, 6)
"""Harmonics of β kept with every session as nameless structure: the first is absorbed or in the catalogue, and those of
an input polynomial up to the fifth order end with the fifth.
"""


def lasting_causes() -> tuple[Signature, ...]:
    """The causes of the catalogue that can act in every session in the same way."""
    return tuple(c for c in CATALOGUE if isinstance(c, Signature) and lasts(c))


def lasts(cause: Signature) -> bool:
    """Whether a cause acts within a session and can last, unlike an event at one row of one session."""
    return cause.can_be_modelled and not cause.clips and "row" not in cause.nonlinear_units


def columns_of(baseline: Baseline) -> Iterator[tuple[Block, Array]]:
    """Every candidate of a session with its columns (R, m, q), m/s² (rad/s) per unit amplitude."""
    for cause in lasting_causes():
        yield from candidates_of(baseline, cause)
    yield from _harmonics(baseline.setting, tuple(s.name for s in baseline.session.sensors))


def candidates_of(baseline: Baseline, cause: Cause) -> Iterator[tuple[Block, Array]]:
    """The candidates of one cause; none where the session does not provide what it needs."""
    setting = baseline.setting
    if not cause.available(setting):
        return
    if isinstance(cause, SensorCause):
        names = tuple(s.name for s in baseline.session.sensors)
        yield from _of_sensors(cause, framed(baseline) if cause.identifier in TANGENTIAL else setting, names)
    elif isinstance(cause, CommonCause):
        yield Block(cause.identifier, "", "", None, len(cause.units)), setting.through(cause.change(setting))


def framed(baseline: Baseline) -> Setting:
    """The setting at the nominal axes."""
    nominal, setting = np.stack([s.nominal_axis for s in baseline.session.sensors]), baseline.setting
    return replace(setting, parameters=replace(setting.parameters, axis=nominal))


def _of_sensors(cause: SensorCause, setting: Setting, names: tuple[str, ...]) -> Iterator[tuple[Block, Array]]:
    """One cause on every sensor that it may act on, in every shape."""
    shapes = TIME_CONSTANTS if cause.nonlinear_units == ("s",) else (None,)
    grid: list[tuple[float, ...]] = [() if shape is None else (shape,) for shape in shapes]
    grids = ((i, grid) for i, kind in enumerate(setting.kinds) if cause.kind in (None, kind))
    for i, _, terms in cause.each(setting, grids):
        for shape, columns in zip(shapes, on_sensor(setting, i, terms), strict=True):
            yield Block(cause.identifier, names[i], setting.kinds[i], shape, len(cause.units)), columns


def _harmonics(setting: Setting, names: tuple[str, ...]) -> Iterator[tuple[Block, Array]]:
    """Nameless waves of β on every sensor and of the applied vector, alike and opposite in the two runs."""
    if setting.beta is None or setting.flipped is None or setting.d_beta is None or setting.d_alpha is None:
        return
    sign = np.where(setting.flipped, -1.0, 1.0)[:, None]
    has_both_runs = setting.has("both runs")
    for order in HARMONICS:
        wave = harmonic(setting, order)
        wave = np.concatenate([wave, sign * wave], axis=1) if has_both_runs else wave
        for i, (name, kind) in enumerate(zip(names, setting.kinds, strict=True)):
            columns = np.zeros((setting.rows, len(names), wave.shape[1]))
            columns[:, i, :] = wave * setting.norm[i]
            yield Block(HARMONIC, name, kind, float(order), wave.shape[1]), columns
        turns = [setting.through(d[..., None] * wave[:, None, None, :]) for d in (setting.d_beta, setting.d_alpha)]
        yield Block(HARMONIC, "", "", float(order), 2 * wave.shape[1]), np.concatenate(turns, axis=-1)
