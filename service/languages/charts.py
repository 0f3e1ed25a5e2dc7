"""Charts in another language: what people read of a definition; fields, values and expressions stay."""

from collections.abc import Callable, Mapping
from typing import Any

READ = frozenset(("title", "text", "description", "subtitle"))
"""Keys of Vega-Lite under which a text stands that people read."""


def chart_in(data: Any, say: Callable[[str], str], locale: Mapping[str, Any]) -> Any:
    """A whole definition, its axes of time and numbers in the language too; ``locale`` as d3 wants it."""
    told = _part_in(data, say)
    if isinstance(told, dict) and "config" in told:
        told["config"] = told["config"] | {"locale": locale}
    return told


def _part_in(data: Any, say: Callable[[str], str]) -> Any:
    """A part of a definition with what people read of it said in another language."""
    if isinstance(data, dict):
        return {k: _said(v, say) if k in READ else _part_in(v, say) for k, v in data.items()}
    if isinstance(data, list | tuple):
        return [_part_in(one, say) for one in data]
    return data


def _said(value: Any, say: Callable[[str], str]) -> Any:
    if isinstance(value, str):
        return say(value)
    if isinstance(value, list | tuple) and all(isinstance(one, str) for one in value):
        return [say(one) for one in value]
    return _part_in(value, say)
