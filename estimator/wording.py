"""Counted things in sentences."""

from estimator.message import Message, say_count


def counted(number: int, noun: str) -> Message:
    """``1 row``, ``3 rows``."""
    return say_count("{n} " + noun, "{n} " + noun + "s", number)


def few(number: int, noun: str) -> Message:
    """``1 row is too few``, ``3 rows are too few``."""
    return say_count("{n} " + noun + " is too few", "{n} " + noun + "s are too few", number)
