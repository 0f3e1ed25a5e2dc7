"""What parameters, programmes and methods are called, and dates as people write them."""

from datetime import date, datetime, timedelta

from estimator.message import joined, say
from estimator.parity.results import SEVERAL

YEAR = timedelta(days=365.25)
"""The Julian year, as rates a year are counted."""
PARAMETER_NAMES = {
    "scale": "scale factor",
    "bias": "bias",
    "quadratic": "quadratic term",
    "axis": "input axis",
    "misalignment": "misalignment",
    SEVERAL: "bias, scale factor and axis together",
}
"""What each parameter is called in sentences."""
FULLER = {"misalignment": "misalignment to the turn axis"}
"""Where a heading, which stands alone, must say more than a sentence."""


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
    return say("{day} {month} {year}", day=at.day, month=f"{at:%b}", year=at.year)


def minute_of(at: datetime) -> str:
    """``7 Mar 2026, 09:30 UTC``."""
    return say("{day}, {time} UTC", day=day_of(at), time=f"{at:%H:%M}")


def month_of(at: date) -> str:
    """``Mar 2026``."""
    return say("{month} {year}", month=f"{at:%b}", year=at.year)
