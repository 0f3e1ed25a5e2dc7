"""Elements of a Digital Calibration Certificate, built as a tree: no text is ever taken for markup."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from lxml.builder import ElementMaker

from estimator.coverage import chance
from estimator.session import ACCELEROMETER
from service.kit.printable import ILLEGAL, Element
from service.papers.records import NOT_STATED
from service.sessions.decision import Verdict

NAMESPACES = {
    "dcc": "https://ptb.de/dcc",
    "si": "https://ptb.de/si",
    "xsi": "http://www.w3.org/2001/XMLSchema-instance",
}
"""XML namespaces by PTB's prefixes."""
NUMBERED = re.compile(r"\d{1,3}(\.\d{1,3}){0,3}")
"""Part of a version that PTB's rules allow after the letter."""
CONFORMITY = {
    Verdict.PASS: "pass",
    Verdict.CONDITIONAL_PASS: "conditionalPass",
    Verdict.CONDITIONAL_FAIL: "conditionalFail",
    Verdict.FAIL: "fail",
}
"""An undecidable verdict has no conformity."""


def plain(text: str) -> str:
    """The text as required by the schema's strings: trimmed, not empty, with legal characters only."""
    return " ".join(ILLEGAL.sub(lambda found: f"‹U+{ord(found[0]):04X}›", text).split()) or NOT_STATED


def _write(element: Element, text: str) -> None:
    element.text = plain(text)


DCC, SI = (ElementMaker({str: _write}, NAMESPACES[prefix], NAMESPACES) for prefix in ("dcc", "si"))
"""``DCC.name(...)`` makes the element ``dcc:name`` of its children, or of its text by `plain`."""


def english(name: str, text: str) -> Element:
    """An element with an English text."""
    return DCC(name, DCC.content(text, lang="en"))


def software(release: str) -> Element:
    """Element of this program; a version that is not only numbers is stated in the name."""
    numbers = NUMBERED.match(release)
    release_number = numbers[0] if numbers else "0"
    name = "imu-health" if release_number == release else f"imu-health {release}"
    return DCC.software(english("name", name), DCC.release(f"v{release_number}"), DCC.type("application"))


def conformity(verdict: Verdict | None) -> Iterator[Element]:
    """The schema's conformity of a verdict, if any."""
    if verdict in CONFORMITY:
        yield DCC.conformity(CONFORMITY[verdict])


ONE, RADIAN = r"\one", r"\radian"
INPUT = {True: r"\metre\second\tothe{-2}", False: r"\radian\second\tothe{-1}"}
PER_INPUT = {True: r"\metre\tothe{-1}\second\tothe{2}", False: r"\radian\tothe{-1}\second"}
"""D-SI of the input of a sensor, and of its inverse: of an accelerometer (True) and of a gyro."""
READINGS = {"V": r"\volt", "mV": r"\milli\volt", "A": r"\ampere", "mA": r"\milli\ampere", "Hz": r"\hertz"}
"""D-SI of reading units; counts and pulses have the unit one."""


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
class CoverageFactor:
    """A coverage factor and its distribution."""

    k: float
    dof: float | None
    """Degrees of freedom of the standard uncertainty; None when the noise is known."""

    @property
    def probability(self) -> float:
        """Coverage probability of an interval ±k·u."""
        return 2.0 * chance(self.k, self.dof) - 1.0

    @property
    def distribution(self) -> str:
        """The distribution of the probability."""
        return "normal" if self.dof is None else f"t, {self.dof:.3g} effective degrees of freedom"


def bare_quantity(name: str, value: float, unit: str) -> Element:
    """A number without uncertainty: a setting, or one stated elsewhere."""
    return DCC.quantity(english("name", name), SI.real(SI.value(repr(float(value))), SI.unit(unit)))


def quantity(name: str, value: float, unit: str, sigma: float | None, factor: CoverageFactor) -> Element:
    """``dcc:quantity`` with ``si:real``; U with its k and coverage."""
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
