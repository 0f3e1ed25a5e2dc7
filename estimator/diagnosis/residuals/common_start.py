"""Baselines of a session and its history, fitted near one another and seen in one frame."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.content import each_remembered
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import near
from estimator.diagnosis.residuals.flipped_run import with_fitted_flip
from estimator.diagnosis.residuals.turns import NEGLIGIBLE, in_frame_of, turns_between
from estimator.session import TWO_AXIS_STAND

ROUNDS = 3
"""Times that a session is fitted from the others' parameters: the turn between them is taken from the fit before."""
WORSE = 2.0
"""Largest ratio of mean square residuals at which a refit is still the session's own minimum: another start may change
only what the readings leave open."""


def baselines(now: Baseline, history: Sequence[Baseline]) -> tuple[Baseline, list[Baseline]]:
    """A session and its earlier ones, each fitted for itself, as they are fitted together: the earlier ones turned into
    the frame of the session.

    On a stand all are fitted from the parameters of the one that observes most. What one of them does not observe (a
    single run leaves a direction open) would else stay at different values, far enough from one another for the second
    order to show as a change of what is observed.
    """
    baseline, earlier = with_fitted_flip(now), about_their_flips(list(history))
    if now.session.programme == TWO_AXIS_STAND and earlier:
        best = min([baseline, *earlier], key=lambda b: float(np.trace(b.covariance)))
        baseline, *earlier = fitted_near([baseline, *earlier], best)
    return baseline, in_frame_of(baseline, earlier)


@each_remembered
def about_their_flips(history: list[Baseline]) -> list[Baseline]:
    """Earlier sessions, each about the turn of its own flipped run."""
    return [with_fitted_flip(h) for h in history]


@each_remembered
def fitted_near(sessions: list[Baseline], best: Baseline) -> list[Baseline]:
    """Baselines fitted anew from the parameters of the ``best``, turned as the block was turned between them."""
    p, fitted = best.parameters, list(sessions)
    moving = [
        k for k, baseline in enumerate(fitted) if baseline is not best and baseline.setting.kinds == best.setting.kinds
    ]
    before = np.zeros((len(fitted), 3, 3))
    for _ in range(ROUNDS):
        if not moving:
            break
        turns = turns_between([fitted[k] for k in moving], [best] * len(moving))
        moved = np.abs(turns - before[moving]).max(axis=(1, 2)) >= NEGLIGIBLE
        before[moving] = turns
        moving = [k for k, still in zip(moving, moved, strict=True) if still]
        starts = [replace(p, axis=p.axis @ before[k].T) for k in moving]
        fits = near([replace(sessions[k].session, flip_turn=np.zeros(3)) for k in moving], starts)
        refits = {k: with_fitted_flip(fit, start) for k, fit, start in zip(moving, fits, starts, strict=True)}
        moving = [k for k in moving if fits_as_well(refits[k], sessions[k])]
        fitted = [refits[k] if k in moving else baseline for k, baseline in enumerate(fitted)]
    return fitted


def fits_as_well(refit: Baseline, original: Baseline) -> bool:
    """Whether a fit from another start reached the session's own minimum. It may not where a sensor is far from that
    start, such as one whose sign is reversed in one of the files."""
    after, before = (float(np.mean(baseline.residual**2 / baseline.variance)) for baseline in (refit, original))
    return after <= WORSE * before
