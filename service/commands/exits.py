"""How a command ends: its exit code, and a line that says why."""

import typer

FAILED = 1
"""Exit code where what was asked for could not be done."""
UNUSABLE = 2
"""Exit code where a file cannot be used."""


def many(number: int, thing: str) -> str:
    """``1 row``, ``12,000 rows``."""
    return f"{number:,} {thing}{'' if number == 1 else 's'}"


def say(line: str) -> None:
    """One line on standard error."""
    typer.echo(" ".join(line.split()), err=True)
