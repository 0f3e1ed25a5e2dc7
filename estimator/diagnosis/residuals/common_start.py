"""Baselines of a session and its history, fitted near one another."""

from collections.abc import Sequence

import numpy as np

from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import parameter_covariance
from estimator.session import TWO_AXIS_STAND, CalibrationSession


def baselines(session: CalibrationSession, history: Sequence[CalibrationSession]) -> tuple[Baseline, list[Baseline]]:
    """Of a session and of every earlier one, from the parameters of the one that observes most.

    What one of them does not observe (a single run leaves a direction open) would else stay at different values, far
    enough from one another for the second order to show as a change of what is observed.
    """
    baseline = baseline_of(session)
    earlier = [baseline_of(h) for h in history]
    if session.programme != TWO_AXIS_STAND or not earlier:
        return baseline, earlier
    best = min([baseline, *earlier], key=lambda b: float(np.trace(parameter_covariance(b))))
    start = best.parameters
    return baseline_of(session, start), [baseline_of(h, start) for h in history]
