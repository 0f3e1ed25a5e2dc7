"""Readiness: whether a unit is warm and still enough for a long measurement, judged by its first minutes.

`readiness` answers, with what a calibration would lose and what to do; the model: `course`.
"""

from estimator.readiness.assess import readiness
from estimator.readiness.question import Allowed, Question
from estimator.readiness.results import Disturbance, DriftOutlook, Readiness, ReadinessState

__all__ = ["Allowed", "Disturbance", "DriftOutlook", "Question", "Readiness", "ReadinessState", "readiness"]
