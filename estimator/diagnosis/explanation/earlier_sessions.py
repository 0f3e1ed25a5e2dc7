"""The benefit of the named causes on another session: amplitudes found here, tested against that session's residuals.

The latest earlier session keeps its own parameters, fitted anew with and without; the effect with its amplitude and
covariance V comes from this session alone. The residuals of the baseline there, z, are of unit covariance without the
effect, and with it of mean X·a and covariance 1 + X V X' (X the trace of the signature there).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.diagnosis.explanation.extended_model import Amplitudes
from estimator.diagnosis.posterior.explained import ExplainedSession, Scored
from estimator.diagnosis.residuals.prediction import LN_2PI, root_mean_square
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.results import Score, Transfer
from estimator.session import Array

CLEAR = 3.0
"""ln evidence by which the earlier session says that it had an effect, or had not: odds of twenty."""


@dataclass(frozen=True, eq=False)
class Effect:
    """Findings as they would show in another session. f amplitudes, in the causes' SI units."""

    columns: Array
    """(R, m, f) m/s² (rad/s) per unit amplitude."""
    amplitude: Array
    """(f,) SI."""
    covariance: Array
    """(f, f) SI."""

    @property
    def absent(self) -> "Effect":
        """The effect with amplitude and covariance zero."""
        return replace(self, amplitude=0 * self.amplitude, covariance=0 * self.covariance)


def transfer(state: ExplainedSession, fitted: Amplitudes, new: Sequence[bool | None]) -> Transfer | None:
    """Scores of the latest earlier session before and after; None where no finding can have acted there.

    ``new``: `are_new` of every finding.
    """
    if not state.history:
        return None
    residuals = WhitenedResiduals.of(state.history[-1])
    lasted = [(f.best, part) for f, part, n in zip(state.detections, fitted.slices, new, strict=True) if not n]
    effect = effect_in(residuals, lasted, fitted)
    if effect is None:
        return None
    started_at = state.history[-1].session.started_at
    return Transfer(started_at, predicted(residuals, effect.absent), predicted(residuals, effect))


def effect_in(
    residuals: WhitenedResiduals, effects: Sequence[tuple[Scored, slice]], fitted: Amplitudes
) -> Effect | None:
    """Some findings, with their places among the amplitudes, in the session of ``residuals``; None if none can show.

    What acts in one session only, or cannot show in that one, is left out.
    """
    columns, places = [], []
    for scored, part in effects:
        if not scored.cause.can_be_modelled:
            continue
        there, width = scored.columns_in(residuals.baseline.setting), len(scored.cause.units)
        if there is not None:
            columns.append(there[..., :width])
            places.append(part.start + np.arange(width))
    if not columns:
        return None
    chosen = np.concatenate(places)
    return Effect(np.concatenate(columns, axis=-1), fitted.value[chosen], fitted.covariance[np.ix_(chosen, chosen)])


def are_new(state: ExplainedSession, fitted: Amplitudes) -> tuple[bool | None, ...]:
    """Whether each finding came since the latest earlier session; None without history, or for changes since then.

    The readings of that session say it: with the effect or without. Where they are undecided, it is how the
    parameters changed.
    """
    if not state.history:
        return (None,) * len(state.detections)
    residuals = WhitenedResiduals.of(state.history[-1])
    return tuple(
        None if f.best.cause.between else is_new(f.best, residuals, effect_in(residuals, [(f.best, part)], fitted))
        for f, part in zip(state.detections, fitted.slices, strict=True)
    )


def is_new(scored: Scored, residuals: WhitenedResiduals, effect: Effect | None) -> bool:
    """Whether one finding came since the session of ``residuals``; ``effect`` as it would show there."""
    if effect is not None:
        gained = predicted(residuals, effect).log_score - predicted(residuals, effect.absent).log_score
        if abs(gained) * residuals.freedom > CLEAR:
            return gained < 0
    return not scored.lasting


def predicted(residuals: WhitenedResiduals, effect: Effect) -> Score:
    """Scores the prediction of a session's readings by an effect."""
    trace = residuals.trace(effect.columns)
    rest = residuals.z - trace @ effect.amplitude
    inner = np.eye(trace.shape[1]) + effect.covariance @ (trace.T @ trace)
    along = trace.T @ rest
    square = float(rest @ rest - along @ np.linalg.solve(inner, effect.covariance @ along))
    volume = float(np.linalg.slogdet(inner)[1])
    R, m = residuals.baseline.residual.shape
    errors = rest[: R * m].reshape(R, m) / residuals.whiten.weight
    rms = root_mean_square(errors, residuals.baseline)
    return Score(
        rms=rms[residuals.baseline.session.block],
        chi2_per_dof=square / residuals.freedom,
        log_score=-0.5 * (square + volume) / residuals.freedom - 0.5 * LN_2PI,
        rms_by_kind=rms,
    )
