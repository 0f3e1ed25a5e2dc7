"""By what a layout is known again: its headings."""

import hashlib
from collections.abc import Mapping
from typing import Any


def fingerprint(seen: Mapping[str, Any]) -> str:
    """SHA-256 of the headings of a first look, in small letters and without spaces."""
    headings = ["".join(column["heading"].casefold().split()) for column in seen["columns"]]
    return hashlib.sha256("\n".join(headings).encode()).hexdigest()
