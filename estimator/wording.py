"""Counted things in sentences."""


def counted(number: int, noun: str) -> str:
    """``1 row``, ``3 rows``."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def few(number: int, noun: str) -> str:
    """``1 row is too few``, ``3 rows are too few``."""
    return f"{counted(number, noun)} {'is' if number == 1 else 'are'} too few"
