"""Charts in another language: what people read of a definition; fields, values and expressions stay."""

from collections.abc import Callable
from typing import Any

READ = frozenset(("title", "text", "description", "subtitle"))
"""Keys of Vega-Lite under which a text stands that people read."""


def chart_in(data: Any, say: Callable[[str], str]) -> Any:
    """A definition, or a part of one, with what people read of it said in another language."""
    if isinstance(data, dict):
        return {k: _said(v, say) if k in READ else chart_in(v, say) for k, v in data.items()}
    if isinstance(data, list | tuple):
        return [chart_in(one, say) for one in data]
    return data


def _said(value: Any, say: Callable[[str], str]) -> Any:
    if isinstance(value, str):
        return say(value)
    if isinstance(value, list | tuple) and all(isinstance(one, str) for one in value):
        return [say(one) for one in value]
    return chart_in(value, say)
