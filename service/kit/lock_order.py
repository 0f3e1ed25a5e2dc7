"""The order in which a thread takes locks, and a check that it computes nothing while it writes.

First a place to read a large file, then the turn to write, then rows: a unit's before those that belong to it. While a
write transaction is open nothing is read from files, calibrated, judged, weighed, diagnosed or forecast: on SQLite it
would block every other writer, on PostgreSQL every other writer to the same unit. Results are computed before and
stored where they still hold, or are left to be computed after.

Tests hold it by the environment variable `IMU_WATCH_WRITING`. In production a slow service is preferred to a broken
one.
"""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from threading import local
from typing import ParamSpec, TypeVar

from estimator.message import say

WATCHED = "IMU_WATCH_WRITING"
Given = ParamSpec("Given")
Result = TypeVar("Result")
_own = local()


class ComputedWhileWritingError(Exception):
    """A mistake of the program: others wait for a transaction that computes."""


@contextmanager
def writing() -> Iterator[None]:
    """Marks this thread's transaction as open until the block ends."""
    _own.is_writing = True
    try:
        yield
    finally:
        _own.is_writing = False


def outside_writing(function: Callable[Given, Result]) -> Callable[Given, Result]:
    """Marks a function that takes long and must not be called in a write transaction."""

    @wraps(function)
    def watched(*args: Given.args, **kwargs: Given.kwargs) -> Result:
        if getattr(_own, "is_writing", False) and WATCHED in os.environ:
            raise ComputedWhileWritingError(
                say("{qualname} is called in a write transaction", qualname=function.__qualname__)
            )
        return function(*args, **kwargs)

    return watched
