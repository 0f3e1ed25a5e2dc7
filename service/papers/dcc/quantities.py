"""Quantities of a Digital Calibration Certificate: value, unit and expanded uncertainty by the rules of D-SI."""

from dataclasses import dataclass

from estimator.coverage import chance
from estimator.session import ACCELEROMETER
from service.kit.xml import Element
from service.papers.dcc.elements import DCC, SI, english

ONE, RADIAN = r"\one", r"\radian"
INPUT = {True: r"\metre\second\tothe{-2}", False: r"\radian\second\tothe{-1}"}
PER_INPUT = {True: r"\metre\tothe{-1}\second\tothe{2}", False: r"\radian\tothe{-1}\second"}
"""D-SI of what a sensor measures, and of its inverse: of an accelerometer (True) and of a gyro."""
READINGS = {"V": r"\volt", "mV": r"\milli\volt", "A": r"\ampere", "mA": r"\milli\ampere", "Hz": r"\hertz"}
"""D-SI of the units that readings come in; counts and pulses have the unit one."""


def value_measure(kind: str, parameter: str, reading_unit: str, *, counted: bool) -> str:
    """The D-SI unit of a parameter's value."""
    linear = kind == ACCELEROMETER
    if parameter == "scale":
        reading = READINGS.get(reading_unit, "")
        return reading + (r"\radian\tothe{-1}" if counted else PER_INPUT[linear])
    return {"bias": INPUT[linear], "quadratic": PER_INPUT[linear]}.get(parameter, RADIAN)


def deviation_measure(kind: str, parameter: str) -> str:
    """The D-SI unit of a deviation: relative for scale, an angle for an axis."""
    return ONE if parameter == "scale" else value_measure(kind, parameter, "", counted=False)


@dataclass(frozen=True)
class Factor:
    """A coverage factor and what it covers."""

    k: float
    dof: float | None
    """Degrees of freedom of the standard uncertainty; None when the noise is known."""

    @property
    def probability(self) -> float:
        """Of an interval ±k·u."""
        return 2.0 * chance(self.k, self.dof) - 1.0

    @property
    def distribution(self) -> str:
        """The law that the probability is of."""
        return "normal" if self.dof is None else f"t, {self.dof:.3g} effective degrees of freedom"


def bare_quantity(name: str, value: float, unit: str) -> Element:
    """A number without an uncertainty: what was set, or is stated elsewhere."""
    return DCC.quantity(english("name", name), SI.real(SI.value(repr(float(value))), SI.unit(unit)))


def quantity(name: str, value: float, unit: str, sigma: float | None, factor: Factor) -> Element:
    """``dcc:quantity`` with ``si:real``; k and its coverage stand with U."""
    real = SI.real(SI.value(repr(float(value))), SI.unit(unit))
    if sigma is not None:
        real.append(
            SI.measurementUncertaintyUnivariate(
                SI.expandedMU(
                    SI.valueExpandedMU(repr(float(factor.k * sigma))),
                    SI.coverageFactor(f"{factor.k:g}"),
                    SI.coverageProbability(f"{factor.probability:.4f}"),
                    SI.distribution(factor.distribution),
                )
            )
        )
    return DCC.quantity(english("name", name), real)
