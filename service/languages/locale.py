"""Axes in another language: the locale of dates and numbers, as d3 wants it."""

from collections.abc import Mapping

from service.languages.language import Language

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
