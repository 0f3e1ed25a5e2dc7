"""Counted things in sentences."""


def counted(number: int, thing: str) -> str:
    """``1 row``, ``3 rows``."""
    return f"{number} {thing}{'' if number == 1 else 's'}"


def few(number: int, thing: str) -> str:
    """``1 row is too few``, ``3 rows are too few``."""
    return f"{counted(number, thing)} {'is' if number == 1 else 'are'} too few"
