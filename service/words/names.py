"""Names and dates as people write them."""

from datetime import datetime, timedelta

YEAR = timedelta(days=365.25)
PARAMETER_NAMES = {
    "scale": "scale factor",
    "bias": "bias",
    "quadratic": "quadratic term",
    "axis": "input axis",
    "misalignment": "misalignment",
}


def day_of(at: datetime) -> str:
    """``7 Mar 2026``."""
    return f"{at.day} {at:%b %Y}"


def month_of(at: datetime) -> str:
    """``Mar 2026``."""
    return f"{at:%b %Y}"
