"""Pure functions worked out once for what they are given: many tests upload the same sessions and print the same."""

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from functools import wraps
from hashlib import sha256
from typing import Any, ParamSpec, TypeVar

import numpy as np

MOST = 400
"""Results of a function that are kept, the latest."""
Given = ParamSpec("Given")
Result = TypeVar("Result")


def once(function: Callable[Given, Result]) -> Callable[Given, Result]:
    """The function, worked out once for equal arguments. Its result is shared, so that nobody may change it."""
    known: dict[bytes, Result] = {}

    @wraps(function)
    def answered(*args: Given.args, **kwargs: Given.kwargs) -> Result:
        key = sha256(repr((_held(args), _held(kwargs))).encode()).digest()
        result = known[key] if key in known else function(*args, **kwargs)
        known[key] = result
        if len(known) > MOST:
            known.pop(next(iter(known)), None)
        return result

    return answered


def _held(part: object) -> Any:
    """A value with equal text where the parts are equal: arrays by their bits."""
    if isinstance(part, np.ndarray):
        return part.dtype.str, part.shape, part.tobytes()
    if is_dataclass(part) and not isinstance(part, type):
        return type(part).__name__, [_held(getattr(part, one.name)) for one in fields(part)]
    if isinstance(part, tuple | list):
        return [_held(one) for one in part]
    if isinstance(part, Mapping):
        return [(_held(key), _held(value)) for key, value in part.items()]
    return part
