"""A JSON object whose fields are open: a document before it is checked, or one that is only passed on."""

from typing import Any

Json = dict[str, Any]
"""Names and values; where the fields are known, a record stands instead."""
