"""JSON as stored in the database: the one place where results of the estimator become text."""

import json
from datetime import date, datetime
from typing import Any

import numpy as np

from estimator.codec import WITH_PARTS, Codec, Form
from estimator.message import say


def json_text(document: Any, *, finite: bool = True) -> str:
    """The document without spaces, numpy scalars as plain bool, int or float.

    ValueError for a number that is not finite, which PostgreSQL rejects, unless ``finite`` is false.
    """
    return json.dumps(document, separators=(",", ":"), allow_nan=not finite, default=_plain)


def _plain(value: object) -> object:
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(say("{name} is not kept as JSON", name=type(value).__name__))


STORED = Codec(
    {
        datetime: Form(datetime.isoformat, datetime.fromisoformat),
        date: Form(date.isoformat, date.fromisoformat),
        **WITH_PARTS,
    }
)
