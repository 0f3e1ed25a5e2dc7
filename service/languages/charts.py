"""Translation of charts: the texts of a definition; fields, values and expressions stay."""

from collections.abc import Callable, Mapping
from typing import Any

from service.languages.language import Language

READ = frozenset(("title", "text", "description", "subtitle"))
"""Keys of texts in Vega-Lite."""


def chart_in(data: Any, say: Callable[[str], str], locale: Mapping[str, Any]) -> Any:
    """A whole definition, its axes of time and numbers in the language too; ``locale`` as d3 wants it."""
    chart = _part_in(data, say)
    if isinstance(chart, dict) and "config" in chart:
        chart["config"] = chart["config"] | {"locale": locale}
    return chart


def _part_in(data: Any, say: Callable[[str], str]) -> Any:
    if isinstance(data, dict):
        return {k: _text_in(v, say) if k in READ else _part_in(v, say) for k, v in data.items()}
    if isinstance(data, list | tuple):
        return [_part_in(item, say) for item in data]
    return data


def _text_in(value: Any, say: Callable[[str], str]) -> Any:
    if isinstance(value, str):
        return say(value)
    if isinstance(value, list | tuple) and all(isinstance(line, str) for line in value):
        return [say(line) for line in value]
    return _part_in(value, say)


MONTHS = (
    *("январь", "февраль", "март", "апрель", "май", "июнь"),
    *("июль", "август", "сентябрь", "октябрь", "ноябрь", "декабрь"),
)
DAYS = ("вс", "пн", "вт", "ср", "чт", "пт", "сб")
LOCALE: Mapping[Language, Mapping[str, Mapping[str, object]]] = {
    Language.RUSSIAN: {
        "time": {
            "dateTime": "%d.%m.%Y %H:%M:%S",
            "date": "%d.%m.%Y",
            "time": "%H:%M:%S",
            "periods": ["", ""],
            "days": DAYS,
            "shortDays": DAYS,
            "months": MONTHS,
            "shortMonths": [name[:3] for name in MONTHS],
        },
        "number": {"decimal": ",", "thousands": "\u202f", "grouping": [3], "currency": ["", ""]},
    }
}
