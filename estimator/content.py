"""Results that depend on nothing but their subject, worked out once: for a session's content, or while an object lives.

Whoever reads a session again has the same one: the next diagnosis of a unit asks for its earlier sessions anew.
"""

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field, fields
from functools import lru_cache
from typing import Any, Protocol, TypeVar, TypeVarTuple
from weakref import WeakKeyDictionary

import numpy as np

from estimator.session import CalibrationSession, Sensor

Rest = TypeVarTuple("Rest")
Result = TypeVar("Result")
Owner = TypeVar("Owner")

REMEMBERED = 32
"""Sessions, those asked for last: the histories of some units."""

LARGEST = 600
"""Readings of a session that is remembered: what is worked out of it is then a megabyte at most."""


FIELDS = {kind: tuple(attribute.name for attribute in fields(kind)) for kind in (CalibrationSession, Sensor)}
"""Attributes by class, for classes that hold arrays and cannot be compared themselves."""


@dataclass(frozen=True)
class Content:
    """A session, equal to any other of the same content."""

    key: Hashable
    session: CalibrationSession = field(compare=False)


def remembered(
    function: Callable[[CalibrationSession, *Rest], Result],
) -> Callable[[CalibrationSession, *Rest], Result]:
    """The function of a session (and of hashable arguments), worked out once for each content that is not large.

    Its result is shared, so that nobody may change it.
    """

    @lru_cache(maxsize=REMEMBERED)
    def known(content: Content, *rest: *Rest) -> Result:
        return function(content.session, *rest)

    def wrapper(session: CalibrationSession, *rest: *Rest) -> Result:
        if session.readings.size > LARGEST:
            return function(session, *rest)
        return known(Content(held(session), session), *rest)

    return wrapper


def once(function: Callable[[Owner, *Rest], Result]) -> Callable[[Owner, *Rest], Result]:
    """The function of an object that never changes (and of hashable arguments), worked out once in the object's life.

    Its result is shared, so that nobody may change it, and neither it nor the rest may hold the object.
    """
    known: WeakKeyDictionary[Owner, dict[Hashable, Result]] = WeakKeyDictionary()

    def wrapper(owner: Owner, *rest: *Rest) -> Result:
        results = known.setdefault(owner, {})
        if rest not in results:
            results[rest] = function(owner, *rest)
        return results[rest]

    return wrapper


class OfSession(Hashable, Protocol):
    """A result worked out of a session; it never changes, and is distinguished from others by identity."""

    @property
    def session(self) -> CalibrationSession: ...


Worked = TypeVar("Worked", bound=OfSession)


def each_remembered(
    function: Callable[[list[Worked], *Rest], list[Result]],
) -> Callable[[list[Worked], *Rest], list[Result]]:
    """The function of several items, whose results do not depend on one another: an item that was asked for before,
    with the same further arguments, is not worked out again unless its session is large.

    Its results are shared, so that nobody may change them.
    """
    known: dict[Hashable, Result] = {}

    def wrapper(items: list[Worked], *rest: *Rest) -> list[Result]:
        before = known.copy()
        results = {item: before[item, *rest] for item in items if (item, *rest) in before}
        missing = [item for item in items if item not in results]
        results |= zip(missing, function(missing, *rest) if missing else [], strict=True)
        for item, result in results.items():
            if item.session.readings.size <= LARGEST:
                known.pop((item, *rest), None)
                known[item, *rest] = result
        for key in list(known)[:-REMEMBERED]:
            known.pop(key, None)
        return [results[item] for item in items]

    return wrapper


def held(part: Any) -> Hashable:
    """A session or a part of one as what can be compared: arrays by their bits."""
    if isinstance(part, np.ndarray):
        return part.dtype.str, part.shape, part.tobytes()
    if isinstance(part, tuple | list):
        return tuple(map(held, part))
    names = FIELDS.get(type(part))
    if names is not None:
        return tuple([held(getattr(part, name)) for name in names])
    value: Hashable = part
    return value
