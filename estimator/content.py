"""What depends on nothing but its subject, worked out once: of a session's content, or of an object while it lives.

Whoever reads a session again has the same one: the next diagnosis of a unit asks for its earlier sessions anew.
"""

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field, fields
from functools import lru_cache, wraps
from typing import Any, Concatenate, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

import numpy as np

from estimator.session import CalibrationSession, Sensor

Rest = ParamSpec("Rest")
Result = TypeVar("Result")
Owner = TypeVar("Owner")

REMEMBERED = 32
"""Sessions, those asked for last: the histories of some units."""

LARGEST = 600
"""Readings of a session that is remembered: what is worked out of it is then a megabyte at most."""


@dataclass(frozen=True)
class Content:
    """A session, equal to any other of the same content."""

    key: Hashable
    session: CalibrationSession = field(compare=False)


def remembered(
    function: Callable[Concatenate[CalibrationSession, Rest], Result],
) -> Callable[Concatenate[CalibrationSession, Rest], Result]:
    """The same function of a session (and of what can be hashed), worked out once for each content that is not large.

    Its result is shared, so that nobody may change it.
    """

    @lru_cache(maxsize=REMEMBERED)
    def known(content: Content, *rest: Rest.args, **named: Rest.kwargs) -> Result:
        return function(content.session, *rest, **named)

    @wraps(function)
    def asked(session: CalibrationSession, *rest: Rest.args, **named: Rest.kwargs) -> Result:
        if session.readings.size > LARGEST:
            return function(session, *rest, **named)
        return known(Content(held(session), session), *rest, **named)

    return asked


def once(function: Callable[[Owner], Result]) -> Callable[[Owner], Result]:
    """The same function of an object that never changes, worked out once while the object lives.

    Its result is shared, so that nobody may change it, and it may not hold the object.
    """
    known: WeakKeyDictionary[Owner, Result] = WeakKeyDictionary()

    @wraps(function)
    def asked(owner: Owner) -> Result:
        if owner not in known:
            known[owner] = function(owner)
        return known[owner]

    return asked


def held(part: Any) -> Hashable:
    """A session or a part of one as what can be compared: arrays by their bits."""
    if isinstance(part, np.ndarray):
        return part.dtype.str, part.shape, part.tobytes()
    if isinstance(part, tuple):
        return tuple(map(held, part))
    if isinstance(part, CalibrationSession | Sensor):
        return tuple(held(getattr(part, own.name)) for own in fields(part))
    value: Hashable = part
    return value
