"""A checked session, or named columns, as a line of JSON followed by plain arrays: the answer of a reading process.

Nothing in it is executed on receipt: no pickle, only the classes of a session, and numeric arrays whose size is checked
before they are received.
"""

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from estimator.message import KEYS, Message, as_document, with_messages
from estimator.session import CalibrationSession, ScreenFinding, Sensor, Site, Stand, StandErrors

CLASSES = {cls.__name__: cls for cls in (CalibrationSession, ScreenFinding, Sensor, Site, Stand, StandErrors)}
DTYPE_KINDS = "fiubU"
"""Numbers, truth values and texts of a fixed width."""
DAMAGED = (ValueError, TypeError, LookupError, RecursionError)
"""Raised for an answer that a reading process did not write as agreed."""

Array = NDArray[Any]


@dataclass(frozen=True)
class Packed:
    """A line, and the arrays that it refers to by their number."""

    line: bytes
    arrays: tuple[Array, ...]


def pack(answer: object) -> Packed:
    """A session, or a document with arrays in it."""
    arrays: list[Array] = []
    tree = _plain(answer, arrays)
    return Packed(json.dumps({"answer": tree, "arrays": [_form(array) for array in arrays]}).encode(), tuple(arrays))


def unpack(line: bytes, most_bytes: int, receive: Callable[[Array], None]) -> Any:
    """Reads a packed answer; ``receive`` fills an array. Raises one of `DAMAGED` for a malformed line."""
    header = json.loads(line)
    forms = [(np.dtype(str(kind)), tuple(map(int, shape))) for kind, shape in header["arrays"]]
    if any(dtype.kind not in DTYPE_KINDS or min(shape, default=0) < 0 for dtype, shape in forms):
        raise ValueError("an array of another kind")
    if sum(dtype.itemsize * prod(shape) for dtype, shape in forms) > most_bytes:
        raise ValueError("more than can be received")
    return _built(header["answer"], tuple(_received(forms, receive)))


def plain_bytes(array: Array) -> memoryview:
    """The bytes of an array, without a copy where it is contiguous."""
    return np.ascontiguousarray(array).reshape(-1).view(np.uint8).data


def _received(forms: list[tuple[np.dtype[Any], tuple[int, ...]]], receive: Callable[[Array], None]) -> Iterator[Array]:
    for dtype, shape in forms:
        array = np.empty(shape, dtype)
        receive(array)
        yield array


def _form(array: Array) -> tuple[str, tuple[int, ...]]:
    return array.dtype.str, array.shape


def _plain(value: object, arrays: list[Array]) -> object:
    if isinstance(value, np.ndarray):
        arrays.append(value)
        return {"array": len(arrays) - 1}
    if is_dataclass(value):
        members = {f.name: _plain(getattr(value, f.name), arrays) for f in fields(value)}
        return {"class": type(value).__name__, "fields": members}
    if isinstance(value, Mapping):
        return {"items": {name: _plain(item, arrays) for name, item in value.items()}}
    if isinstance(value, tuple | list):
        return [_plain(item, arrays) for item in value]
    return as_document(value) if isinstance(value, Message) else value


def _built(value: Any, arrays: tuple[Array, ...]) -> Any:
    if isinstance(value, list):
        return tuple(_built(item, arrays) for item in value)
    if not isinstance(value, dict):
        return value
    if value.keys() <= KEYS:
        return with_messages(value)
    if "array" in value:
        return arrays[value["array"]]
    if "items" in value:
        return {name: _built(item, arrays) for name, item in value["items"].items()}
    return CLASSES[value["class"]](**{name: _built(item, arrays) for name, item in value["fields"].items()})
