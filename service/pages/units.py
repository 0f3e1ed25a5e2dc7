"""People's units and the writing of numbers: the one place where pages leave SI."""

from dataclasses import dataclass
from math import floor, isfinite, log10, pi

from estimator.session import GYROSCOPE

STANDARD_GRAVITY = 9.80665
"""m/s² in one g, as people count in g; not the local gravity."""
DEGREE = pi / 180
THIN = "\u202f"
HARD = "\u00a0"
"""A space that does not break the line."""
MINUS = "\u2212"
UNKNOWN = "\u2013"


@dataclass(frozen=True)
class PeopleUnit:
    """A unit that people read: the number they see is the SI number times ``factor``."""

    label: str
    factor: float

    def of(self, si: float | None) -> float | None:
        """The SI number in this unit; None stays None."""
        return None if si is None else si * self.factor


PPM = PeopleUnit("ppm", 1e6)
PERCENT = PeopleUnit("%", 1e2)
ARCSEC = PeopleUnit("″", 3600 / DEGREE)
ARC_DEGREE = PeopleUnit("°", 1 / DEGREE)
MICRO_G = PeopleUnit("µg", 1e6 / STANDARD_GRAVITY)
MILLI_G = PeopleUnit("mg", 1e3 / STANDARD_GRAVITY)
DEGREE_PER_HOUR = PeopleUnit("°/h", 3600 / DEGREE)
DEGREE_PER_SECOND = PeopleUnit("°/s", 1 / DEGREE)
MICRO_G_PER_G2 = PeopleUnit("µg/g²", 1e6 * STANDARD_GRAVITY)
MILLI_G_PER_G2 = PeopleUnit("mg/g²", 1e3 * STANDARD_GRAVITY)
PPM_PER_RATE = PeopleUnit("ppm/(°/s)", 1e6 * DEGREE)
PERCENT_PER_RATE = PeopleUnit("%/(°/s)", 1e2 * DEGREE)
PER_G = PeopleUnit("per g", STANDARD_GRAVITY)
PER_RATE = PeopleUnit("per °/s", DEGREE)

FINE_AND_COARSE = {
    ("accelerometer", "scale"): (PPM, PERCENT),
    ("accelerometer", "bias"): (MICRO_G, MILLI_G),
    ("accelerometer", "quadratic"): (MICRO_G_PER_G2, MILLI_G_PER_G2),
    ("accelerometer", "axis"): (ARCSEC, ARC_DEGREE),
    ("gyroscope", "scale"): (PPM, PERCENT),
    ("gyroscope", "bias"): (DEGREE_PER_HOUR, DEGREE_PER_SECOND),
    ("gyroscope", "quadratic"): (PPM_PER_RATE, PERCENT_PER_RATE),
    ("gyroscope", "axis"): (ARCSEC, ARC_DEGREE),
}
"""The unit of precise instruments, and the one to change to when its numbers would pass 9,999."""


def deviation_unit(kind: str, parameter: str, largest: float) -> PeopleUnit:
    """The unit for deviations up to ``largest`` (SI; relative for scale)."""
    fine, coarse = FINE_AND_COARSE[kind, parameter]
    return fine if not isfinite(largest) or abs(largest) * fine.factor < 1e4 else coarse


def value_unit(kind: str, parameter: str, largest: float) -> PeopleUnit:
    """The unit for values up to ``largest``; scale factors are read per g or per degree a second."""
    if parameter == "scale":
        return PER_RATE if kind == GYROSCOPE else PER_G
    return deviation_unit(kind, parameter, largest)


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


def signed(value: float | None, expanded: float | None, unit: PeopleUnit) -> str:
    """The same for a change: with a plus where it is not negative."""
    text = measured(value, expanded, unit)
    return text if value is None or text.startswith(MINUS) else f"+{text}"


def limit(tolerance: float, unit: PeopleUnit, one_sided: bool) -> str:
    """``±40 µg``, or ``30 ″`` for what cannot be negative."""
    return f"{'' if one_sided else '±'}{number(unit.of(tolerance))}{THIN}{unit.label}"


def measured(value: float | None, expanded: float | None, unit: PeopleUnit) -> str:
    """``12.3 ± 1.4 µg`` of SI numbers, rounded as the uncertainty deserves."""
    shown, spread = unit.of(value), unit.of(expanded)
    digits = decimals(spread)
    if digits is None:
        return f"{number(shown)}{THIN}{unit.label}"
    return f"{number(shown, digits)}{HARD}±{HARD}{number(spread, digits)}{THIN}{unit.label}"


def size_in_words(count: int) -> str:
    """``12.3 kB``."""
    for size, label in ((1e6, "MB"), (1e3, "kB")):
        if count >= size:
            return f"{count / size:.1f}{THIN}{label}"
    return f"{count} bytes"
