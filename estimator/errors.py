"""Errors of the estimator.

ValueError
└── SessionError         a session that cannot be used; holds every problem found
    ├── FormatError      the file is not imu-session/1, or cannot be read at all
    └── ScheduleError    a well-formed session whose rows cannot support its programme

"Not observable" and "not converged" are results, never exceptions.
"""

from dataclasses import dataclass

from estimator.message import joined, say


@dataclass(frozen=True)
class Problem:
    """One thing wrong with a session file: where it is, what it is, and what to do about it."""

    field: str
    message: str
    row: int | None = None
    """Row of the table, counted from 1 as people count; None when the problem is not in one row."""

    def __str__(self) -> str:
        place = self.field if self.row is None else say("{field}, row {row}", field=self.field, row=self.row)
        return say("{place}: {message}", place=place, message=self.message)


def problem_at(field: str, message: str, row: int | None = None, /, **parts: object) -> Problem:
    """One thing wrong, its message the template of a sentence with its ``parts``."""
    return Problem(field, say(message, **parts), row)


class SessionError(ValueError):
    """A session that cannot be used; ``problems`` holds every fault found, in file order."""

    def __init__(self, problems: "list[Problem] | tuple[Problem, ...]", source: str | None = None) -> None:
        self.problems = tuple(problems)
        self.source = source
        head = f"{source}: " if source else ""
        super().__init__(head + joined("; ", map(str, self.problems)))


class FormatError(SessionError):
    """The file is not imu-session/1, or cannot be read at all."""


class ScheduleError(SessionError):
    """A well-formed session whose rows cannot support its programme."""
