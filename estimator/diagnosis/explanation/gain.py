"""The benefit of the named causes: prediction of readings that took no part in the fit.

Positions are held out fold by fold. The rest of the rows fit the model, without and with the signatures, and predict
the held-out rows with full predictive covariance; all in the whitened frame, where rows are independent. *Before* is
the baseline of the record as it came, with the noise as stated; *after* holds the named causes, excess noise among
them, the record corrected. Both log scores are densities of the same numbers, readings in their stated sigmas: what a
larger sigma costs is counted.

Causes and shapes are those that all rows together show; only their amplitudes are fitted anew in every fold. That
flatters a name by little: it stands out of the rest by far more than what one sixth of the rows has to say of the
choice. The gain is a measurement for people and selects nothing.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.diagnosis.explanation.earlier_sessions import transfer
from estimator.diagnosis.explanation.extended_model import Amplitudes
from estimator.diagnosis.posterior.explained import Detection, ExplainedSession
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.prediction import (
    FOLDS,
    Prediction,
    by_sensor,
    predicted,
    predicted_without_effects,
    root_mean_square,
    row_redundancy,
)
from estimator.diagnosis.results import Gain, Score
from estimator.session import Array


def gain(state: ExplainedSession, given: Baseline | None, fitted: Amplitudes, new: Sequence[bool | None]) -> Gain:
    """Scores of held-out positions and of an earlier session, before and after.

    ``given``: of the record as it came, where it had to be corrected; ``new``: of every finding, whether it came since
    the history.
    """
    named = [f for f in state.detections if not f.best.cause.between]
    given = as_stated(state) if given is None or state.courses else given
    before, after = (
        score(given, predicted_without_effects(given)),
        score(state.baseline, predicted_with(state.baseline, named)),
    )
    dearer = volume(state.baseline) - volume(given)
    after = replace(after, log_score=after.log_score + dearer / float(row_redundancy(given).sum()))
    return Gain(before, after, "positions", transfer(state, fitted, new))


def predicted_with(baseline: Baseline, named: Sequence[Detection]) -> Prediction:
    """Every row predicted with some findings in the model, from the folds that do not hold it."""
    if not named:
        return predicted_without_effects(baseline)
    columns = [f.best.shape.columns for f in named]
    return predicted(baseline, [columns] * FOLDS, [np.concatenate([spread(f, named) for f in named])] * FOLDS)


def spread(detection: Detection, named: Sequence[Detection]) -> Array:
    """(q,) standard deviation of a finding's amplitudes beforehand, SI: nothing is known of a lone one's; sensors that
    share a course have sizes of one spread in standard errors, as each is hardly known by itself."""
    trace = detection.best.trace
    unknown = np.full(trace.shape[1], np.inf)
    if not detection.event:
        return unknown
    alike = [f.best.statistic for f in named if (f.best.cause, f.event) == (detection.best.cause, detection.event)]
    size = np.sqrt(max(float(np.mean(alike)) - 1.0, 1.0)) / max(float(np.linalg.norm(trace[:, 0])), 1e-300)
    return np.concatenate([[size], unknown[1:]])


def as_stated(state: ExplainedSession) -> Baseline:
    """The baseline with the noise that the file states."""
    if state.stated is state.baseline.variance:
        return state.baseline
    return replace(state.baseline, variance=state.stated)


def volume(baseline: Baseline) -> float:
    """ln of the factor by which whitening scales volumes; directions of which nothing is known are integrated out."""
    weight = 1 / np.sqrt(baseline.variance)
    unknown = np.isinf(baseline.row_sigma)
    scaled = baseline.row * weight[..., None] * np.where(unknown, 1.0, baseline.row_sigma)[:, None, :]
    size = np.linalg.svd(scaled, compute_uv=False)
    share = np.where(unknown.any(axis=1, keepdims=True), np.where(size > 0, size, 1.0), np.sqrt(1 + size**2))
    return float(np.log(weight).sum() - np.log(share).sum())


def score(baseline: Baseline, rows: Prediction) -> Score:
    """Scores the prediction of a session's rows."""
    return Score(
        rms=root_mean_square(rows.error, baseline)[baseline.session.block],
        chi2_per_dof=rows.square / rows.count,
        log_score=rows.log_score / rows.count,
        rms_by_kind=root_mean_square(rows.error, baseline),
        rms_by_sensor=by_sensor(rows.error, baseline),
    )
