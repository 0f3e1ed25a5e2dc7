"""Diagnosis: measured session → baseline simulation → residuals → causes → extended model → gain."""

from estimator.diagnosis.diagnose import diagnose
from estimator.diagnosis.explanation.accepted import calibrate_extended
from estimator.diagnosis.results import Diagnosis, Finding

__all__ = ["Diagnosis", "Finding", "calibrate_extended", "diagnose"]
