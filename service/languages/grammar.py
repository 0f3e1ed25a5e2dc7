"""What a language has beside its catalogue: how it counts, joins and dates."""

import re
from calendar import month_name
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from service.languages.language import Language

DATE = re.compile(r"(\d{1,2} )?(Jan|Feb|Mar|Apr|May|Jun|Jul|Aug|Sep|Oct|Nov|Dec)( \d{4})")
"""``7 Mar 2026`` or ``Mar 2026``, as `service.kit.names` writes it."""
AXIS = re.compile(r"(Jan|Feb|Mar|Apr|May|Jun|Jul|Aug|Sep|Oct|Nov|Dec)( \d{2})?")
"""``Jan`` or ``Jan 04``, as an axis of time has it."""
MONTH_NAMES = tuple(month_name)[1:]


@dataclass(frozen=True)
class Grammar:
    """Of one language."""

    plural: Callable[[int], int]
    """Which plural form a number needs."""
    joints: Mapping[str, str]
    """How parts of a sentence are joined."""
    months: Mapping[str, str]
    """Months as dates have them, by their English abbreviations."""
    month_names: Sequence[str]
    """Months as they stand alone, at an axis of time."""
    days: Sequence[str]
    """Days of the week, from Sunday on, short."""

    @property
    def time(self) -> dict[str, object]:
        """The locale of axes of time, as d3 wants it."""
        return {
            "dateTime": "%d.%m.%Y %H:%M:%S",
            "date": "%d.%m.%Y",
            "time": "%H:%M:%S",
            "periods": ["", ""],
            "days": self.days,
            "shortDays": self.days,
            "months": self.month_names,
            "shortMonths": [name[:3] for name in self.month_names],
        }

    def date(self, text: str) -> str:
        """A date in English in this language; empty where it is none."""
        if axis := AXIS.fullmatch(text):
            return f"{axis[2] or ''} {self.months[axis[1]][:3]}".strip()
        if text in MONTH_NAMES:
            return self.month_names[MONTH_NAMES.index(text)]
        found = DATE.fullmatch(text)
        return f"{found[1] or ''}{self.months[found[2]]}{found[3]}" if found else ""


JOINTS = {Language.RUSSIAN: {" and ": " и ", " or ": " или "}}
MONTHS = {
    Language.RUSSIAN: {
        "Jan": "января",
        "Feb": "февраля",
        "Mar": "марта",
        "Apr": "апреля",
        "May": "мая",
        "Jun": "июня",
        "Jul": "июля",
        "Aug": "августа",
        "Sep": "сентября",
        "Oct": "октября",
        "Nov": "ноября",
        "Dec": "декабря",
    }
}
"""In the case that follows a day and every preposition that the catalogue puts before a date."""
NAMES_OF_MONTHS = {
    Language.RUSSIAN: (
        *("январь", "февраль", "март", "апрель", "май", "июнь"),
        *("июль", "август", "сентябрь", "октябрь", "ноябрь", "декабрь"),
    )
}
DAYS = {Language.RUSSIAN: ("вс", "пн", "вт", "ср", "чт", "пт", "сб")}
