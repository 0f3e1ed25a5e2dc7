"""The session fitted about the effects found: a strong one moves a fit by more than is linear.

The effect is taken out before the fit and put back into the residuals, as what it is (Gauss–Newton).
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.term import MOVED, NOISE, Term
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of, readings_without
from estimator.diagnosis.residuals.flipped_run import with_fitted_flip
from estimator.diagnosis.residuals.refitted import refitted
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array

ResidualsOf = Callable[[Baseline], WhitenedResiduals]

CURVED = 0.02
"""Standard errors of a reading that the second order of an effect may come to: less hides in the noise of hundreds."""


LARGEST = 0.3
"""Share of the applied vector up to which an effect is taken out: a larger one is hardly told from the sensor's own
parameters."""

WORSE = 2.0
"""Largest ratio of χ² at which a refit is still the same minimum: a session that hardly observes what an effect
resembles has others."""


def about_effects(
    baseline: Baseline, start: InputInformation, terms: Sequence[Term], residuals_of: ResidualsOf
) -> Baseline | None:
    """The baseline fitted about what terms make of the readings; None where that is as good as linear, or
    what it was fitted about already. ``start``: the information with nothing found;
    ``residuals_of``: the residuals of a baseline, with its change since the history."""
    effect = made_of_readings(start, terms)[: baseline.residual.size].reshape(baseline.residual.shape)
    new = effect if baseline.course is None else effect - baseline.course
    share = np.abs(effect / baseline.setting.norm).max()
    if share > LARGEST or share * np.abs(new / np.sqrt(baseline.variance)).max() < CURVED:
        return None
    session, p = baseline.session, baseline.parameters
    without = replace(session, readings=readings_without(session, p.scale, effect), flip_turn=np.zeros(3))
    fitted = with_fitted_flip(baseline_of(without, p), p)
    about = refitted(
        replace(
            baseline,
            session=replace(fitted.session, readings=session.readings),
            setting=replace(fitted.setting, turn=baseline.setting.turn),
            residual=fitted.residual + effect,
            constant=fitted.constant,
            row=fitted.row,
            course=effect,
        )
    )
    return about if energy(residuals_of(about)) < WORSE * energy(residuals_of(baseline)) else None


def energy(residuals: WhitenedResiduals) -> float:
    """χ² with nothing found, the history's part in it."""
    return float(residuals.z @ residuals.z)


def made_of_readings(start: InputInformation, terms: Sequence[Term]) -> Array:
    """(D,) the likeliest change of the inputs by all terms that change readings; what moved the parameters for good is
    no part of it."""
    acting = [t for t in terms if t.name not in (NOISE, MOVED) and not moves_for_good(t)]
    if not acting:
        return np.zeros(len(start.a))
    W, variance = np.concatenate([t.columns for t in terms], axis=1), np.concatenate([t.variance for t in terms])
    mean = np.concatenate([np.zeros(len(t.variance)) if t.mean is None else t.mean for t in terms])
    AW = start.A @ W
    u = mean + np.linalg.solve(np.diag(1 / variance) + W.T @ AW, W.T @ start.a - AW.T @ (W @ mean))
    each = np.split(u, np.cumsum([len(t.variance) for t in terms])[:-1])
    return np.asarray(sum(t.columns @ own for t, own in zip(terms, each, strict=True) if t in acting))


def moves_for_good(term: Term) -> bool:
    """Whether a term is a change of what the session calibrates, rather than an effect on its readings."""
    cause = None if term.effect is None else term.effect.cause
    return cause is not None and (
        cause.between or cause.moves_parameters or cause.turns_block or cause.turns_flipped_run
    )
