"""Calibration: from a measured session to parameters with covariance."""

from estimator.calibration.batch import calibrate_many
from estimator.calibration.calibrate import calibrate

__all__ = ["calibrate", "calibrate_many"]
