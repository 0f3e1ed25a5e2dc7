"""JSON as the database keeps it: the one place where what the estimator found becomes text."""

import json
from datetime import datetime
from typing import Any

import numpy as np

from estimator.codec import WITH_PARTS, Codec, Form
from estimator.message import say


def json_text(document: Any, *, finite: bool = True) -> str:
    """The document without spaces, a scalar of numpy as the plain bool, int or float that it is.

    ValueError where a number is not finite, which PostgreSQL does not take, unless ``finite`` is false.
    """
    return json.dumps(document, separators=(",", ":"), allow_nan=not finite, default=_plain)


def _plain(value: object) -> object:
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(say("{name} is not kept as JSON", name=type(value).__name__))


STORED = Codec({datetime: Form(datetime.isoformat, datetime.fromisoformat), **WITH_PARTS})
