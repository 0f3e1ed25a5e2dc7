"""Reduces a session to the statistics that are kept for its groups.

The record is corrected first: clipped channels, slips of the record and readings that do not belong to the rest. Then
every sensor's scatter is held against its stated noise, after what the session shows plainly by itself is taken out.
Where it contradicts it, because the noise is misstated or because structure is left that no candidate explains, the
session enters with the scatter that it has and never with full weight. Noise that is estimated from the session itself
makes its scores Student's t: they enter the evidence as normal deviates of the same tail probability.
"""

import re
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.special import chdtr

from estimator.calibration.calibrate import averaged
from estimator.causes.catalogue import CATALOGUE
from estimator.diagnosis.record.clipping import unclipped
from estimator.diagnosis.record.silent import refuse_silent
from estimator.diagnosis.record.undo import undo_record_errors
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.flipped_run import with_fitted_flip
from estimator.diagnosis.residuals.refitted import refitted
from estimator.diagnosis.residuals.whitened import INVISIBLE, WhitenedResiduals
from estimator.groups.candidates import columns_of
from estimator.groups.scatter import with_residual_scatter
from estimator.groups.scores import beside, eigen_scores, shrinkage, starts_of
from estimator.groups.statistics import Block, SessionStatistics, quantised, shared
from estimator.least_squares import orthonormal
from estimator.message import say
from estimator.moments import in_utc
from estimator.session import Array, CalibrationSession
from estimator.significance import p_value

LEFT_OUT = re.compile(r"reading (\d+) left out")
MUTE = 1e9
"""Times its variance a lone wrong reading has no weight."""

PLAIN = 1e-3
"""p-value, all candidates of a session together, at which one shows plainly in the session by itself."""

MOST = 4
"""Plain effects and outliers each that are taken out before the scatter is judged; more are structure and count."""

LEANING = 0.1
"""Tail at which a sensor leans towards what all of its kind show: one in ten does so by chance."""

DOUBTFUL = 1e-3
"""p-value, over the sensors, of a scatter that contradicts the stated noise."""


@dataclass(frozen=True, eq=False)
class WhitenedSession:
    """A whitened session. N rows, D columns."""

    residuals: WhitenedResiduals
    blocks: tuple[Block, ...]
    trace: Array
    """(N, D) standard errors per unit amplitude, outliers projected out."""
    z: Array
    """(N,) standard errors."""
    reach: Array
    """(D,) dimensionless."""
    freedom: Array
    """(N,) degrees of freedom of every row."""
    outliers: tuple[int, ...] = ()
    """Rows of z that do not belong to the rest."""

    @cached_property
    def score(self) -> Array:
        """(D,) U, 1/SI."""
        return np.asarray(self.trace.T @ self.z)

    @cached_property
    def information(self) -> Array:
        """(D, D) F, 1/SI²."""
        return np.asarray(self.trace.T @ self.trace)


def statistics_of(session: CalibrationSession) -> SessionStatistics:
    """The statistics of a session of a programme that calibrates a block.

    Raises
    ------
    ScheduleError : the session cannot be calibrated at all, or a channel reads the same in every row.
    """
    return kept(session, *put_right(session))


def put_right(session: CalibrationSession) -> tuple[Baseline, tuple[str, ...]]:
    """A session fitted with its record corrected, and the corrections, in words."""
    rows = averaged(session)
    refuse_silent(rows)
    clips, whole = unclipped(rows, CATALOGUE)
    errors, right = undo_record_errors(baseline_of(whole), (), CATALOGUE)
    words: list[str] = [say("{name} clipped", name=session.sensors[c.sensor].name) for c in clips]
    words += [
        say("{name} left out, rows {row} to {last}", name=a.sensor, row=a.row, last=a.last_row) for a in rows.set_aside
    ]
    words += [e.undone.cause.identifier for e in errors]
    return with_fitted_flip(right), tuple(words)


def as_kept(session: CalibrationSession, record: SessionStatistics) -> Baseline:
    """A session fitted as its record took it: put right, in the noise that it shows, lone readings without weight."""
    baseline, _ = put_right(session)
    alone = [int(found[1]) - 1 for words in record.put_right if (found := LEFT_OUT.fullmatch(words))]
    if np.all(record.noise_factor == 1) and not alone:
        return baseline
    variance = baseline.variance * record.noise_factor**2
    variance.flat[alone] *= MUTE
    return refitted(replace(baseline, variance=variance))


def kept(session: CalibrationSession, baseline: Baseline, words: tuple[str, ...]) -> SessionStatistics:
    """The statistics of a fitted session whose record is right."""
    stated, seen = baseline, without_outliers(seen_in(baseline))
    left, freedom = left_of(seen)
    energy, free = of_sensors(seen, left**2), of_sensors(seen, freedom)
    claims = contradicted(baseline, energy, free)
    if claims:
        baseline = refitted(with_residual_scatter(baseline, claims, plain_columns(seen)))
        seen = without_outliers(seen_in(baseline))
        left, freedom = left_of(seen)
        energy, free = of_sensors(seen, left**2), of_sensors(seen, freedom)
    size = np.linalg.norm(seen.trace, axis=0)
    estimated = np.where(baseline.unstated, free, np.inf)
    for sensors in claims:
        estimated[sensors] = free[sensors].sum()
    factor = np.sqrt(np.median(baseline.variance / stated.variance, axis=0))
    return SessionStatistics(
        unit=session.unit,
        unit_type=session.unit_type or "",
        stand="" if session.stand is None else session.stand.id,
        started_at=in_utc(session.started_at),
        sensors=tuple(s.name for s in session.sensors),
        blocks=shared(seen.blocks),
        size=size,
        score=seen.score / np.where(size > 0, size, 1.0),
        correlation=quantised(seen.information, size),
        reach=seen.reach,
        shrink=shrinking(seen, estimated),
        energy=energy,
        freedom=free,
        whole=of_sensors(seen, seen.z**2),
        whole_freedom=of_sensors(seen, seen.freedom),
        noise_factor=factor,
        put_right=words + tuple(say("reading {j} left out", j=j + 1) for j in seen.outliers),
    )


def seen_in(baseline: Baseline) -> WhitenedSession:
    """The session's residuals and the traces of all candidates."""
    residuals = WhitenedResiduals.of(baseline)
    found = list(columns_of(baseline))
    columns = np.concatenate([c for _, c in found], axis=-1)
    white = residuals.whitened(columns)
    trace = residuals.remaining_of(white)
    shown = np.linalg.norm(trace, axis=0) > INVISIBLE * np.linalg.norm(white, axis=0)
    reach = (np.abs(columns) / baseline.setting.norm[None, :, None]).max(axis=(0, 1))
    return WhitenedSession(
        residuals, tuple(b for b, _ in found), trace * shown, residuals.z, reach, residuals.row_freedom
    )


def without_outliers(seen: WhitenedSession) -> WhitenedSession:
    """The session without readings that do not belong to the rest: each is left to an amplitude of its own.

    The rest is what else the sensor leaves, effects included: a lone reading must stand out of them too.
    """
    rows, sensors = seen.residuals.baseline.residual.size, seen.residuals.sensor_of_row
    for _ in range(MOST):
        left, freedom = seen.z, seen.freedom
        free = np.maximum(freedom, 0.05)
        energy, whole = of_sensors(seen, left**2)[sensors], of_sensors(seen, freedom)[sensors]
        square = left**2 / free
        rest = np.maximum((energy - square) / np.maximum(whole - 1, 1), 1.0)
        tail = p_value(square / rest, 1) * rows
        tail[rows:] = 1.0
        worst = int(np.argmin(tail))
        if tail[worst] > PLAIN or freedom[worst] < 0.2 or whole[worst] < 4:
            break
        seen = without_row(seen, worst)
    return seen


def without_row(seen: WhitenedSession, row: int) -> WhitenedSession:
    """The session with one row of z projected out."""
    spike = -seen.residuals.basis @ seen.residuals.basis[row]
    spike[row] += 1.0
    for other in seen.outliers:
        spike[other] = 0.0
    spike /= np.linalg.norm(spike)
    return replace(
        seen,
        trace=seen.trace - np.outer(spike, spike @ seen.trace),
        z=seen.z - spike * (spike @ seen.z),
        freedom=seen.freedom - spike**2,
        outliers=(*seen.outliers, row),
    )


def plainly(seen: WhitenedSession) -> list[int]:
    """Blocks that the session shows plainly by itself, one after another, each given those before."""
    found: list[int] = []
    for _ in range(MOST):
        statistic, freedom = beside(seen.blocks, seen.score, seen.information, found)
        tail = p_value(statistic, freedom) * len(seen.blocks)
        best = int(np.argmin(tail))
        if tail[best] > PLAIN:
            break
        found.append(best)
    return found


def plain_basis(seen: WhitenedSession) -> Array:
    """(N, f) orthonormal, dimensionless: traces of what the session shows plainly by itself."""
    starts = starts_of(seen.blocks)
    found = plainly(seen)
    columns = [seen.trace[:, starts[k] : starts[k + 1]] for k in found]
    if not columns:
        return np.zeros((len(seen.z), 0))
    return orthonormal(np.concatenate(columns, axis=1), 1e-3)


def plain_columns(seen: WhitenedSession) -> Array | None:
    """(R, m, q), m/s² (rad/s): columns of what the session shows plainly by itself; None where that is nothing."""
    chosen = {seen.blocks[k] for k in plainly(seen)}
    found = [c for b, c in columns_of(seen.residuals.baseline) if b in chosen]
    return np.concatenate(found, axis=-1) if found else None


def left_of(seen: WhitenedSession) -> tuple[Array, Array]:
    """(N,) standard errors that plain effects leave, and (N,) degrees of freedom of every row."""
    basis = plain_basis(seen)
    return seen.z - basis @ (basis.T @ seen.z), seen.freedom - (basis**2).sum(axis=1)


def of_sensors(seen: WhitenedSession, values: Array) -> Array:
    """(m,) sums of values (N,), any unit, over the rows of each sensor."""
    m = len(seen.residuals.baseline.unstated)
    return np.asarray((seen.residuals.sensor_of_row[: len(values)] == np.arange(m)[:, None]) @ values)


def contradicted(baseline: Baseline, energy: Array, freedom: Array) -> list[list[int]]:
    """Sensors whose scatter is not as stated, those that are off by one factor together.

    All of a kind are, where together they contradict it and half of them lean the same way; else those that scatter
    more each by itself. One alone that scatters less is believed as stated: with few readings, what all share of a row
    can be attributed to it until nothing is left of its noise. ``energy`` (m,) χ² with its degrees of ``freedom`` (m,).
    """
    free = np.maximum(freedom, 1e-3)
    less, more = chdtr(free, energy), p_value(energy, free)
    stated = ~baseline.unstated & (freedom > 2)
    claims: list[list[int]] = []
    for kind in dict.fromkeys(baseline.setting.kinds):
        of_kind = np.flatnonzero(stated & np.array([k == kind for k in baseline.setting.kinds]))
        if not len(of_kind):
            continue
        tails = chdtr(free[of_kind].sum(), energy[of_kind].sum()), p_value(energy[of_kind].sum(), free[of_kind].sum())
        leaning = (less, more)[int(np.argmin(tails))][of_kind] < LEANING
        if min(tails) < DOUBTFUL and 2 * leaning.sum() >= len(of_kind):
            claims.append(of_kind.tolist())
        else:
            claims += [[int(i)] for i in of_kind if more[i] < DOUBTFUL / len(energy)]
    return claims


def shrinking(seen: WhitenedSession, estimated: Array) -> Array:
    """(B,) dimensionless: by how much each candidate's score is as unlikely as a normal one.

    ``estimated`` (m,): degrees of freedom from which the noise of each sensor was estimated; infinite where stated.
    """
    if np.isinf(estimated).all():
        return np.ones(len(seen.blocks))
    statistic, q = eigen_scores(seen.blocks, seen.score, seen.information)
    names = [s.name for s in seen.residuals.baseline.session.sensors]
    whole = float(np.where(np.isinf(estimated), np.inf, of_sensors(seen, seen.freedom)).sum())
    free = np.array([estimated[names.index(b.sensor)] if b.sensor else whole for b in seen.blocks])
    return shrinkage(statistic, q, free)
