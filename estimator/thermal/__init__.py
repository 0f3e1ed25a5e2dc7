"""The thermal programme: bias and scale factor of every sensor over temperature."""

from estimator.thermal.calibrate import calibrate_thermal

__all__ = ["calibrate_thermal"]
