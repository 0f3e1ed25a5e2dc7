"""What a language has beside its catalogue: how it counts, joins and dates."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from service.languages.language import Language

DATE = re.compile(r"(\d{1,2} )?(Jan|Feb|Mar|Apr|May|Jun|Jul|Aug|Sep|Oct|Nov|Dec)( \d{4})")
"""``7 Mar 2026`` or ``Mar 2026``, as `service.words.names` writes it."""


@dataclass(frozen=True)
class Grammar:
    """Of one language."""

    plural: Callable[[int], int]
    """Which plural form a number needs."""
    joints: Mapping[str, str]
    """How parts of a sentence are joined."""
    months: Mapping[str, str]
    """Months as dates have them, by their English abbreviations."""

    def date(self, text: str) -> str:
        """A date in English in this language; empty where it is none."""
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
