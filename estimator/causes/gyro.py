"""Causes of gyros and of the stand that shows them the Earth's rotation."""

import numpy as np

from estimator.causes.contract import CommonCause, SensorCause, Setting
from estimator.session import GYROSCOPE, Array


class GSensitivity(SensorCause):
    identifier = "g-sensitivity"
    scope = "gyro"
    lasts = True
    equation = "k·n (3)"
    units = ("(rad/s)/(m/s²)", "(rad/s)/(m/s²)", "(rad/s)/(m/s²)")
    needs = frozenset({"gravity"})
    kind = GYROSCOPE
    sentence = "The bias of {sensors} depends on specific force (g-sensitivity)."
    advice = "Model the three g-sensitivity coefficients of this gyro; the usual origin is mass unbalance."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 3) specific force, m/s²."""
        assert setting.force is not None
        return setting.force


class SeenByGyros(CommonCause):
    """An error of the stand that gyros alone see."""

    scope = "gyro"
    kind = GYROSCOPE
    units = ("rad",)

    def on_gyros(self, change: Array, setting: Setting) -> Array:
        """(R, m, 3, 1) rad/s per rad: the change (R, m, 3) where the sensor is a gyro, zero elsewhere."""
        acts = np.array([kind == GYROSCOPE for kind in setting.kinds], dtype=float)
        return (change * acts[None, :, None])[..., None]


class LatitudeEntry(SeenByGyros):
    identifier = "latitude-entry"
    equation = "ω turned in the meridian by k: true latitude = latitude + k"
    needs = frozenset({"stand", "history"})
    between = True
    sentence = (
        "The latitude in the record is not that of the stand: all gyros measure another direction of the Earth's "
        "rotation."
    )
    advice = "Correct the latitude (and χ) in the record and upload it again."

    def change(self, setting: Setting) -> Array:
        """(R, m, 3, 1) change of ω with its elevation, rad/s per rad."""
        assert setting.d_alpha is not None
        return self.on_gyros(setting.d_alpha, setting)


class OffMeridian(SeenByGyros):
    identifier = "meridian-error"
    equation = "ω turned about the vertical by k: the stand does not point along the meridian"
    needs = frozenset({"stand", "both runs"})
    sentence = "The stand does not point along the meridian."
    advice = "Align the stand with true north again (gyrocompass or star sight) and repeat the session."

    def change(self, setting: Setting) -> Array:
        """(R, m, 3, 1) change of ω with the heading, rad/s per rad."""
        assert setting.d_beta is not None
        cos = np.linalg.norm(setting.d_beta, axis=-1, keepdims=True) / np.linalg.norm(setting.n, axis=-1, keepdims=True)
        return self.on_gyros(-setting.d_beta / cos * np.cos(setting.latitude), setting)
