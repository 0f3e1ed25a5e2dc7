"""Causes in the stand: they move the applied vector, so they are common to all sensors."""

from typing import ClassVar

import numpy as np

from estimator.causes.contract import CommonCause, Setting
from estimator.session import Array


def harmonic(setting: Setting, order: int) -> Array:
    """(R, 2) sin and cos of a multiple of β, dimensionless."""
    assert setting.beta is not None
    return np.stack([np.sin(order * setting.beta), np.cos(order * setting.beta)], axis=-1)


class BetaPattern(CommonCause):
    """A cause that is a pattern of β errors: `pattern` (R, q), rad per unit amplitude."""

    scope = "stand"
    needs = frozenset({"stand"})
    periods: ClassVar[int] = 1
    """Periods per turn, of a periodic error."""

    def pattern(self, setting: Setting) -> Array:
        """(R, q) β error, rad per unit amplitude; unless told otherwise sin and cos of a multiple of β."""
        return harmonic(setting, self.periods)

    def change(self, setting: Setting) -> Array:
        """(R, m, 3, q) m/s² (rad/s) per unit amplitude."""
        assert setting.d_beta is not None
        return setting.d_beta[..., None] * self.pattern(setting)[:, None, None, :]


class AlphaPattern(BetaPattern):
    """A cause that is a pattern of α errors: `pattern` (R, q), rad per unit amplitude."""

    def change(self, setting: Setting) -> Array:
        """(R, m, 3, q) m/s² (rad/s) per unit amplitude."""
        assert setting.d_alpha is not None
        return setting.d_alpha[..., None] * self.pattern(setting)[:, None, None, :]


class BetaEccentricity(BetaPattern):
    identifier = "beta-eccentricity"
    equation = "δβ = k1·sin β + k2·cos β"
    units = ("rad", "rad")
    sentence = "The head's angle scale is off centre: its error has one period per turn."
    advice = "Read the scale at two opposite places and average, or enter the head's correction table."


class BetaSecondHarmonic(BetaPattern):
    identifier = "beta-second-harmonic"
    equation = "δβ = k1·sin 2β + k2·cos 2β"
    units = ("rad", "rad")
    periods = 2
    sentence = "The head's angle scale is oval: its error has two periods per turn."
    advice = "Enter the head's correction table; have the angle scale checked."


class BetaScale(BetaPattern):
    identifier = "beta-scale"
    equation = "δβ = k·(β − β̄)"
    units = ("1",)
    sentence = "The head's steps do not add up to a full turn: each is slightly too long or too short."
    advice = "Check the angle steps over a full turn; look for slip or a wrong divider setting."

    def pattern(self, setting: Setting) -> Array:
        """(R, 1) β − β̄, rad."""
        assert setting.beta is not None
        return (setting.beta - setting.beta.mean())[:, None]


class AxisWobble(AlphaPattern):
    identifier = "axis-wobble"
    equation = "δα = k1·sin β + k2·cos β"
    units = ("rad", "rad")
    sentence = "The head's axis wobbles as it turns."
    advice = "Check the head's bearings and the clamping of the platform."


class LevellingY(BetaPattern):
    identifier = "levelling-y"
    equation = "θ_y beyond its stated σ"
    units = ("rad",)
    needs = frozenset({"stand", "both runs"})
    sentence = "The stand was not level across its tilt axis."
    advice = "Level the stand again with the cross level and repeat the session."

    def change(self, setting: Setting) -> Array:
        """(R, m, 3, 1) −1/cos α of the change with β, m/s² (rad/s) per rad.

        cos α is read off the length of dn/dβ against that of n.
        """
        assert setting.d_beta is not None
        cos = np.linalg.norm(setting.d_beta, axis=-1, keepdims=True) / np.linalg.norm(setting.n, axis=-1, keepdims=True)
        gyro = np.array([kind == "gyroscope" for kind in setting.kinds])
        share = np.where(gyro, np.sin(setting.latitude), 1.0)[None, :, None]
        return (-setting.d_beta / cos * share)[..., None]


class AlphaShift(AlphaPattern):
    identifier = "alpha-shift"
    equation = "α of the flipped run differs by k"
    units = ("rad",)
    needs = frozenset({"stand", "both runs"})
    sentence = "The head's axis had another elevation in the flipped run."
    advice = "Lock the elevation before turning the block and check it after; repeat the flipped run."

    def pattern(self, setting: Setting) -> Array:
        """(R, 1) 1 in the flipped run, rad per rad."""
        assert setting.flipped is not None
        return setting.flipped.astype(float)[:, None]


class StandDrift(AlphaPattern):
    identifier = "stand-drift"
    equation = "δα = k·(t − t̄)"
    units = ("rad/s",)
    needs = frozenset({"stand", "time"})
    grows_an_angle = True
    sentence = "The stand sinks or tilts slowly through the session."
    advice = "Check the stand's foundation and clamps; level it before and after the session."

    def pattern(self, setting: Setting) -> Array:
        """(R, 1) t − t̄, s."""
        assert setting.time is not None
        return (setting.time - setting.time.mean())[:, None]
