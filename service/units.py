"""People's units for deviations, and how they are written in sentences. SI ends here."""

from dataclasses import dataclass
from math import floor, isfinite, log10, pi

STANDARD_GRAVITY = 9.80665
"""m/s² in one g, as people count in g; not the local gravity."""
DEGREE = pi / 180


@dataclass(frozen=True)
class DeviationUnit:
    """The number that people read is the SI number times ``factor``."""

    label: str
    factor: float


PPM = DeviationUnit("ppm", 1e6)
ARCSEC = DeviationUnit("arcsec", 3600 / DEGREE)

DEVIATION_UNITS = {
    ("accelerometer", "scale"): PPM,
    ("accelerometer", "bias"): DeviationUnit("µg", 1e6 / STANDARD_GRAVITY),
    ("accelerometer", "quadratic"): DeviationUnit("µg/g²", 1e6 * STANDARD_GRAVITY),
    ("accelerometer", "axis"): ARCSEC,
    ("gyroscope", "scale"): PPM,
    ("gyroscope", "bias"): DeviationUnit("°/h", 3600 / DEGREE),
    ("gyroscope", "quadratic"): DeviationUnit("ppm/(°/s)", 1e6 * DEGREE),
    ("gyroscope", "axis"): ARCSEC,
}


def in_words(kind: str, parameter: str, si: float, *, signed: bool = False) -> str:
    """``+62 µg``: a deviation with two or three significant digits and its unit."""
    unit = DEVIATION_UNITS[kind, parameter]
    number = si * unit.factor
    if not isfinite(number):
        return f"unknown {unit.label}"
    digits = 0 if number == 0 else max(0, 1 - floor(log10(abs(number))))
    sign = "+" if signed and number > 0 else ""
    return f"{sign}{number:,.{digits}f} {unit.label}".replace("-", "−")
