"""Time axes in another language: d3's locale of dates."""

from collections.abc import Mapping

from service.languages.language import Language

MONTHS = (
    *("январь", "февраль", "март", "апрель", "май", "июнь"),
    *("июль", "август", "сентябрь", "октябрь", "ноябрь", "декабрь"),
)
DAYS = ("вс", "пн", "вт", "ср", "чт", "пт", "сб")
TIME: Mapping[Language, Mapping[str, object]] = {
    Language.RUSSIAN: {
        "dateTime": "%d.%m.%Y %H:%M:%S",
        "date": "%d.%m.%Y",
        "time": "%H:%M:%S",
        "periods": ["", ""],
        "days": DAYS,
        "shortDays": DAYS,
        "months": MONTHS,
        "shortMonths": [name[:3] for name in MONTHS],
    }
}
