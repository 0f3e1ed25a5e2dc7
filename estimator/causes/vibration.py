"""A zero that follows the vibration: the sensor's curvature makes a steady part of what swings.

While a position is averaged the input swings by w about its mean a. A response with a quadratic part c answers on
average with c·(a + w)² = c·a² + c·w², so the zero moves by the curvature times the variance of the input (IEEE Std
1293: vibration rectification error). What swings fast goes through other curvature than what a stand applies, so the
coefficient is one of its own and not the quadratic term of the calibration.
"""

from estimator.causes.contract import SensorCause, Setting, column
from estimator.session import ACCELEROMETER, Array


class VibrationRectification(SensorCause):
    identifier = "vibration-rectification"
    scope = "environment"
    equation = "k·(σ² − mean σ²), σ² the variance of the input within a row"
    units = ("(m/s²)⁻¹",)
    needs = frozenset({"vibration"})
    kind = ACCELEROMETER
    sentence = "The bias of {sensors} depends on the vibration at the position."
    advice = "Measure while no machinery near the stand runs, or damp it; model the coefficient for use in vibration."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 1) σ² − mean σ², (m/s²)²."""
        assert setting.vibration is not None
        return column(setting.vibration[:, i] - setting.vibration[:, i].mean())
