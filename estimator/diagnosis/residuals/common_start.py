"""Baselines of a session and its history, fitted near one another and seen in one frame."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.flipped_run import about_its_flip, with_its_flip
from estimator.diagnosis.residuals.turns import NEGLIGIBLE, in_the_frame_of, turn_between
from estimator.session import TWO_AXIS_STAND

ROUNDS = 3
"""Times that a session is fitted from the others' parameters: the turn between them is taken from the fit before."""


def baselines(now: Baseline, history: Sequence[Baseline]) -> tuple[Baseline, list[Baseline]]:
    """A session and its earlier ones, each fitted for itself, as they are fitted together: the earlier ones turned into
    the frame of the session.

    On a stand all are fitted from the parameters of the one that observes most. What one of them does not observe (a
    single run leaves a direction open) would else stay at different values, far enough from one another for the second
    order to show as a change of what is observed.
    """
    baseline = about_its_flip(now)
    earlier = [about_its_flip(h) for h in history]
    if now.session.programme == TWO_AXIS_STAND and earlier:
        best = min([baseline, *earlier], key=lambda b: float(np.trace(b.covariance)))
        baseline, *earlier = [fitted_near(one, best) for one in (baseline, *earlier)]
    return baseline, in_the_frame_of(baseline, earlier)


def fitted_near(one: Baseline, best: Baseline) -> Baseline:
    """The baseline fitted anew from the parameters of the ``best``, turned as the block was turned between them."""
    if one is best or one.setting.kinds != best.setting.kinds:
        return one
    p, found, before = best.parameters, one, np.zeros((3, 3))
    for _ in range(ROUNDS):
        turn = turn_between(found, best)
        if np.abs(turn - before).max() < NEGLIGIBLE:
            break
        found, before = with_its_flip(one.session, replace(p, axis=p.axis @ turn.T)), turn
    return found
