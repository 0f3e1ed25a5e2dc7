"""Measures that people use (µg, ppm, arcsec), and numbers rounded as their uncertainty deserves. SI ends here."""

from collections.abc import Collection
from dataclasses import dataclass
from datetime import date, datetime, timedelta
from functools import lru_cache
from math import floor, isfinite, log10, pi

from estimator.applied_vector import STANDARD_GRAVITY
from estimator.coverage import coverage_factor
from estimator.message import joined, say
from estimator.parity.results import SEVERAL
from estimator.results import Calibration, SensorCalibration
from estimator.session import ACCELEROMETER, GYROSCOPE

DEGREE = pi / 180
"""rad."""
THIN = "\u202f"
"""The narrow space between a number and its measure, and between groups of three digits."""
HARD = "\u00a0"
"""A space that does not break the line."""
MINUS = "\u2212"
"""The true one, as wide as a plus."""
UNKNOWN = "\u2013"
"""Shown for a number that is not known: a dash."""
COVERAGE = 2.0
"""k of the uncertainties that are shown where no decision states its own."""


@dataclass(frozen=True)
class Measure:
    """The number that people read is the SI number times ``factor``."""

    label: str
    factor: float


PPM = Measure("ppm", 1e6)
"""Measure of relative quantities."""
ARCSEC = Measure("arcsec", 3600 / DEGREE)
"""Measure of small angles, rad."""

READABLE = 1e4
"""A number from which on a coarser measure is easier to read."""
MEASURES = {
    ("accelerometer", "scale"): PPM,
    ("accelerometer", "bias"): Measure("µg", 1e6 / STANDARD_GRAVITY),
    ("accelerometer", "quadratic"): Measure("µg/g²", 1e6 * STANDARD_GRAVITY),
    ("accelerometer", "axis"): ARCSEC,
    ("gyroscope", "scale"): PPM,
    ("gyroscope", "bias"): Measure("°/h", 3600 / DEGREE),
    ("gyroscope", "quadratic"): Measure("ppm/(°/s)", 1e6 * DEGREE),
    ("gyroscope", "axis"): ARCSEC,
    ("gyroscope", "misalignment"): ARCSEC,
}
COARSE_MEASURES = {
    ("accelerometer", "scale"): Measure("%", 1e2),
    ("accelerometer", "bias"): Measure("mg", 1e3 / STANDARD_GRAVITY),
    ("accelerometer", "quadratic"): Measure("mg/g²", 1e3 * STANDARD_GRAVITY),
    ("accelerometer", "axis"): Measure("°", 1 / DEGREE),
    ("gyroscope", "scale"): Measure("%", 1e2),
    ("gyroscope", "bias"): Measure("°/s", 1 / DEGREE),
    ("gyroscope", "quadratic"): Measure("%/(°/s)", 1e2 * DEGREE),
    ("gyroscope", "axis"): Measure("°", 1 / DEGREE),
    ("gyroscope", "misalignment"): Measure("°", 1 / DEGREE),
}
"""Measures in place of the fine ones when their numbers would pass 9,999."""
NOISE = {
    ("accelerometer", "quantisation"): Measure("mm/s", 1e3),
    ("accelerometer", "white-noise"): Measure("µg/√Hz", 1e6 / STANDARD_GRAVITY),
    ("accelerometer", "bias-instability"): Measure("µg", 1e6 / STANDARD_GRAVITY),
    ("accelerometer", "random-walk"): Measure("µg/√s", 1e6 / STANDARD_GRAVITY),
    ("gyroscope", "quantisation"): ARCSEC,
    ("gyroscope", "white-noise"): Measure("°/√h", 60 / DEGREE),
    ("gyroscope", "bias-instability"): Measure("°/h", 3600 / DEGREE),
    ("gyroscope", "random-walk"): Measure("°/h/√h", 3600 * 60 / DEGREE),
}
"""Measures of the terms of noise at rest, as in data sheets."""
PER_G = Measure(say("per g"), STANDARD_GRAVITY)
"""Unit of the scale factors of accelerometers."""
PER_RATE = Measure(say("per °/s"), DEGREE)
"""Unit of the scale factors of gyros."""


def leading_kind(kinds: Collection[str]) -> str:
    """The kind whose measures represent a whole block: accelerometers where it holds any."""
    return ACCELEROMETER if ACCELEROMETER in kinds else GYROSCOPE


def in_measure(si: float | None, measure: Measure) -> float | None:
    """The SI number as people read it; None stays None."""
    return None if si is None else si * measure.factor


def deviation_measure(kind: str, parameter: str, largest: float) -> Measure:
    """The measure for deviations up to ``largest`` (SI; relative for scale)."""
    fine, coarse = MEASURES[kind, parameter], COARSE_MEASURES[kind, parameter]
    return fine if not isfinite(largest) or abs(largest) * fine.factor < READABLE else coarse


def value_measure(kind: str, parameter: str, largest: float) -> Measure:
    """The measure for values up to ``largest``; scale factors are read per g or per degree a second."""
    if parameter == "scale":
        return scale_measure(kind)
    return deviation_measure(kind, parameter, largest)


def scale_measure(kind: str) -> Measure:
    """The unit per which scale factors are counted."""
    return PER_RATE if kind == GYROSCOPE else PER_G


def decimals(uncertainty: float | None) -> int | None:
    """Digits after the point for two significant digits of an uncertainty; None when it says nothing."""
    if uncertainty is None or not isfinite(uncertainty) or uncertainty <= 0:
        return None
    return min(12, max(0, 1 - floor(log10(uncertainty))))


def number(value: float | None, digits: int | None = None) -> str:
    """A number for reading, grouped, with a true minus; four significant digits unless decimals are given."""
    if value is None or not isfinite(value):
        return UNKNOWN
    if digits is None:
        places = 0 if value == 0 else min(12, max(0, 3 - floor(log10(abs(value)))))
        text = f"{abs(value):,.{places}f}"
        text = text.rstrip("0").rstrip(".") if "." in text else text
    else:
        text = f"{abs(value):,.{digits}f}"
    text = text.replace(",", THIN)
    negative = value < 0 and any(c in "123456789" for c in text)
    return MINUS + text if negative else text


def signed(value: float | None, expanded: float | None, measure: Measure) -> str:
    """A change for reading, with a plus where it is not negative."""
    text = measured(value, expanded, measure)
    return text if value is None or text.startswith(MINUS) else "+" + text


def limit(tolerance: float, measure: Measure, one_sided: bool) -> str:
    """``±40 µg``, or ``30 ″`` for what cannot be negative."""
    return ("" if one_sided else "±") + number(in_measure(tolerance, measure)) + THIN + measure.label


def measured(value: float | None, expanded: float | None, measure: Measure) -> str:
    """``12.3 ± 1.4 µg`` of SI numbers, rounded as the uncertainty deserves."""
    shown, spread = in_measure(value, measure), in_measure(expanded, measure)
    digits = decimals(spread)
    if digits is None:
        return number(shown) + THIN + measure.label
    return f"{number(shown, digits)}{HARD}±{HARD}{number(spread, digits)}{THIN}" + measure.label


def size_in_words(count: int) -> str:
    """``12.3 kB``."""
    for size, label in ((1e6, "MB"), (1e3, "kB")):
        if count >= size:
            return f"{count / size:.1f}{THIN}{label}"
    return say("{count} bytes", count=count)


def in_words(kind: str, parameter: str, si: float, *, signed: bool = False) -> str:
    """``+62 µg``: a deviation with two or three significant digits and its measure."""
    measure = MEASURES[kind, parameter]
    shown = si * measure.factor
    if not isfinite(shown):
        return say("unknown {label}", label=measure.label)
    digits = 0 if shown == 0 else max(0, 1 - floor(log10(abs(shown))))
    sign = "+" if signed and shown > 0 else ""
    return f"{sign}{shown:,.{digits}f} ".replace("-", "−") + measure.label


def coverage_in_words(calibration: Calibration, k: float) -> str:
    """``k = 2``, or the range that Student's t makes of it where the noise was estimated from few readings."""
    dofs = _degrees_of_freedom(calibration)
    if not dofs:
        return f"k = {number(k)}"
    most, least = (coverage_factor(k, dof) for dof in (min(dofs), max(dofs)))
    count = _range(min(dofs), max(dofs), 0)
    degrees = "one effective degree" if count == "1" else say("{number} effective degrees", number=count)
    parts = {"least": _range(least, most, 2), "degrees": degrees}
    return say("k = {least}, by Student's t: the noise is estimated with {degrees} of freedom", **parts)


def noise_is_estimated(calibration: Calibration) -> bool:
    """Whether any uncertainty rests on noise that the readings themselves tell."""
    return bool(_degrees_of_freedom(calibration))


def _degrees_of_freedom(calibration: Calibration) -> list[float]:
    every = (dof for sensor in calibration.sensors for dof in (sensor.axis_dof, *_of_numbers(sensor)))
    return [dof for dof in every if dof is not None]


def _of_numbers(sensor: SensorCalibration) -> tuple[float | None, ...]:
    """Degrees of freedom of the parameters that are numbers."""
    return tuple(e.dof for e in (sensor.scale, sensor.bias, sensor.quadratic, sensor.misalignment) if e is not None)


def _range(low: float, high: float, digits: int) -> str:
    """``2.1 to 2.9``, or one number where both read the same."""
    first, last = number(low, digits), number(high, digits)
    return first if first == last else say("{first} to {last}", first=first, last=last)


YEAR = timedelta(days=365.25)
"""The Julian year, as rates a year are counted."""
PARAMETER_NAMES = {
    "scale": "scale factor",
    "bias": "bias",
    "quadratic": "quadratic term",
    "axis": "input axis",
    "misalignment": "misalignment",
    "g_sensitivity": "g-sensitivity",
    SEVERAL: "bias, scale factor and axis together",
}
"""Names of the parameters in sentences."""
FULLER = {"misalignment": "misalignment to the turn axis"}
"""Fuller names for a heading, which stands alone."""


def heading(parameter: str) -> str:
    """``Scale factor``: a parameter's name at the head of a column, a chart or a section."""
    return FULLER.get(parameter, PARAMETER_NAMES[parameter]).capitalize()


def spaced(identifier: str) -> str:
    """``as found`` of ``as-found``."""
    return identifier.replace("-", " ")


def method_name(method: str) -> str:
    """``turntable, analytic`` of ``turntable/analytic``."""
    return joined(", ", map(spaced, method.split("/")))


def day_of(at: date) -> str:
    """``7 Mar 2026``."""
    return _written(at.year, at.month, at.day)


@lru_cache(maxsize=4096)
def _written(year: int, month: int, day: int) -> str:
    """A page writes one day at many points."""
    return say("{day} {month} {year}", day=day, month=f"{date(year, month, day):%b}", year=year)


def minute_of(at: datetime) -> str:
    """``7 Mar 2026, 09:30 UTC``, or ``22:30 UTC+13:00`` where it is by the clock of a place."""
    return say("{day}, {time} {zone}", day=day_of(at), time=f"{at:%H:%M}", zone=zone_of(at))


def zone_of(at: datetime) -> str:
    """``UTC+13:00``."""
    return f"UTC{at.isoformat(timespec='minutes')[-6:]}" if at.utcoffset() else "UTC"


def month_of(at: date) -> str:
    """``Mar 2026``."""
    return say("{month} {year}", month=f"{at:%b}", year=at.year)
