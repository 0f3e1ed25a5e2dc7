"""Causes inside one sensor. Model equation terms after IEEE Std 1293 where it names them."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from estimator.causes.contract import Cause, GridCause, SensorCause, Setting, Shape, column
from estimator.session import Array


def across(setting: Setting, i: int) -> tuple[Array, Array]:
    """p·n and o·n (R,) of sensor i, m/s² (rad/s): the components across its input axis."""
    return setting.across[:, i, 0], setting.across[:, i, 1]


class CubicNonlinearity(SensorCause):
    identifier = "cubic-nonlinearity"
    lasts = True
    equation = "k·a³"
    units = ("(m/s²)⁻²",)
    sentence = "{sensors} has a cubic nonlinearity."
    advice = (
        "Model the cubic term for this sensor; a rise since earlier sessions points to its suspension or electronics."
    )

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 1) a³, (m/s²)³."""
        return column(setting.a[:, i] ** 3)


class OddQuadratic(SensorCause):
    identifier = "odd-quadratic"
    lasts = True
    equation = "k·a·|a|"
    units = ("(m/s²)⁻¹",)
    sentence = "{sensors} has a sign-dependent quadratic nonlinearity (K_oq)."
    advice = "Model the odd quadratic term of this sensor; inputs above 1 g separate it from a cubic term."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 1) a·|a|, (m/s²)²."""
        a = setting.a[:, i]
        return column(a * np.abs(a))


class ScaleAsymmetry(SensorCause):
    identifier = "scale-asymmetry"
    lasts = True
    equation = "k·|a|"
    units = ("1",)
    sentence = "{sensors} has a different scale factor for positive and negative input."
    advice = "Check the sensor's loop electronics for unequal gains; model the asymmetry until then."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 1) |a|, m/s²."""
        return column(np.abs(setting.a[:, i]))


class BiasAsymmetry(SensorCause):
    identifier = "bias-asymmetry"
    lasts = True
    equation = "k·sign(a)"
    units = ("m/s²",)
    sentence = "{sensors} has a different bias for positive and negative input (K_0′, a dead zone)."
    advice = "Check for friction, a dead zone or crossover distortion in the sensor's output stage."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 1) sign a, dimensionless."""
        return column(np.sign(setting.a[:, i]))


class CrossCoupling(SensorCause):
    identifier = "cross-coupling"
    lasts = True
    equation = "a·(k1·(p·n) + k2·(o·n))"
    units = ("(m/s²)⁻¹", "(m/s²)⁻¹")
    sentence = (
        "{sensors} has cross-coupling: its output depends on the input times the acceleration across its axis (K_ip, "
        "K_io)."
    )
    advice = "Model the cross-coupling of this sensor; the usual origin is a pendulum mounted out of its plane."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 2) a·(p·n) and a·(o·n), (m/s²)²."""
        p, o = across(setting, i)
        a = setting.a[:, i]
        return column(a * p, a * o)


class CrossAxisQuadratic(SensorCause):
    identifier = "cross-axis-quadratic"
    lasts = True
    equation = "k1·(p·n)² + k2·(p·n)(o·n)"
    units = ("(m/s²)⁻¹", "(m/s²)⁻¹")
    sentence = "{sensors} responds to the square of the acceleration across its axis (K_pp, K_po)."
    advice = "Model the cross-axis quadratic terms of this sensor; check its mounting for stress."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 2) (p·n)² and (p·n)(o·n), (m/s²)²."""
        p, o = across(setting, i)
        return column(p * p, p * o)


class Hysteresis(SensorCause):
    identifier = "hysteresis"
    lasts = True
    equation = "k·sign(a_j − a_{j−1}), 0 at the first position of a run"
    units = ("m/s²",)
    sentence = "{sensors} reads differently for rising and falling input."
    advice = "Approach each position from both sides and average; check the suspension for friction."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 1) sign of the rise of a, dimensionless."""
        a = setting.a[:, i]
        rise = np.diff(a, prepend=a[0])
        rise = np.where(np.abs(rise) < 1e-9 * setting.norm[i], 0.0, np.sign(rise))
        return column(np.where(setting.first_of_run, 0.0, rise))


class BiasPerPosition(SensorCause):
    identifier = "bias-per-position"
    equation = "k1·sin β + k2·cos β"
    units = ("m/s²", "m/s²")
    needs = frozenset({"stand", "both runs"})
    alike = True
    sentence = "The bias of {sensors} depends on the head's angle, not on gravity: cable, supply or a magnetic field."
    advice = "Secure the cables, look for magnets and ferrous parts near the head, check the slip rings' supply."

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 2) sin β and cos β, dimensionless."""
        assert setting.beta is not None
        return column(np.sin(setting.beta), np.cos(setting.beta))


class Saturation(GridCause):
    """The nonlinear parameters are the limit at the input, reported as the amplitude, and the side: 0 both, ±1 one."""

    identifier = "saturation"
    equation = "reading clipped beyond a limit"
    units = ("m/s²",)
    nonlinear_units = ("m/s²", "side")
    shape_words = "limit"
    clips = True
    sentence = "{sensors} is clipped: its reading stops at a limit."
    advice = "Lower the converter's gain or use a range that holds the largest input, and repeat the session."
    deepest = 10
    """Levels of input, from the largest down, that the limit is tried between."""

    bounded = True

    def beyond(self, setting: Setting, i: int, side: Array | float) -> tuple[Array, Array]:
        """Size (..., R) of what sensor i should have read on sides (..., 1), at the input, m/s² (rad/s), and its sign
        (R,)."""
        h = setting.input[:, i]
        return np.where(np.equal(side, 0), np.abs(h), side * h), np.sign(h)

    def grid_of(self, setting: Setting, i: int) -> Iterator[tuple[float, ...]]:
        for side in (0.0, 1.0, -1.0):
            size, _ = self.beyond(setting, i, side)
            levels = np.unique(np.round(size / setting.norm[i], 5))[::-1][: self.deepest + 1]
            for upper, lower in pairwise(levels):
                for limit in (lower, (upper + lower) / 2):
                    yield (float(limit * setting.norm[i]), side)

    def terms(self, setting: Setting, i: int, grid: Sequence[tuple[float, ...]]) -> Array:
        """(S, R, 1) part of the input that the limit cuts off, m/s²."""
        limit, side = np.split(np.array(grid), 2, axis=1)
        size, sign = self.beyond(setting, i, side)
        return column(-sign * np.maximum(size - limit, 0.0))

    def reported(self, setting: Setting, shape: Shape, amplitude: Array, sigma: Array) -> tuple[Array, Array]:
        """The limit (1,) and its sigma (1,), m/s² (rad/s): what is cut off on average, moved from the
        tried limit to where the amplitude is one."""
        (i,), (limit, side) = shape.sensors, shape.nonlinear
        size, _ = self.beyond(setting, i, side)
        depth = float((size - limit)[size > limit].mean())
        return limit + (1 - amplitude) * depth, sigma * depth


class ReadingOutlier(GridCause):
    identifier = "reading-outlier"
    equation = "k at one position"
    units = ("m/s²",)
    nonlinear_units = ("row",)
    shape_words = "at"
    passing = True
    sentence = "{sensors} has one outlying reading."
    advice = "Repeat that position; leave the reading out of the calibration."

    def grid(self, setting: Setting) -> Iterator[tuple[float, ...]]:
        for row in range(setting.rows):
            yield (float(row),)

    def terms(self, setting: Setting, i: int, grid: Sequence[tuple[float, ...]]) -> Array:
        """(S, R, 1) 1 in one row, else 0, dimensionless."""
        return column((np.arange(setting.rows) == np.array(grid)).astype(float))


class ExcessNoise(Cause):
    """The amplitude is the extra standard deviation of one reading at the input."""

    identifier = "excess-noise"
    scope = "sensor"
    equation = "variance above the stated one, no mean effect"
    units = ("m/s²",)
    sentence = "{sensors} is noisier than its stated uncertainty."
    advice = "Look for vibration, a loose connector or a bad converter; average longer and state the true uncertainty."
