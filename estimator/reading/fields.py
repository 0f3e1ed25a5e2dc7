"""One JSON object of a session file: typed look-ups that record what is wrong and where."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from estimator.message import joined, say
from estimator.reading.interval import Interval
from estimator.reading.problems import Problems, shown

UNSTORABLE = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ud800-\udfff]")
"""Control characters and lone surrogates, which databases and XML refuse."""
NUMBERS = (int, float, np.integer, np.floating)
"""Types that count as numbers, bool apart."""
LONGEST_NAME = 200
"""Characters: a name stands in headings, file names and indices."""
LONGEST_NOTE = 100_000
"""Characters: fifty pages, which is no note any more."""


@dataclass(frozen=True)
class Fields:
    """An object of the file and where it stands in it."""

    values: Mapping[str, object]
    path: str
    problems: Problems

    def place(self, key: str) -> str:
        """The place of a key, as people write it: ``site.latitude_deg``."""
        return f"{self.path}.{key}" if self.path else key

    def add(self, key: str, message: str, /, **parts: object) -> None:
        """Record a fault of one key."""
        self.problems.add(self.place(key), message, **parts)

    def has(self, key: str) -> bool:
        """Whether the key is given; null is the same as leaving it out."""
        return self.values.get(key) is not None

    def required_text(self, key: str, advice: str) -> str:
        """A required name: one line, not empty."""
        if not self.has(key):
            self.add(key, "missing; {advice}", advice=advice)
            return ""
        text = self._text(key, LONGEST_NAME)
        if text == "":
            self.add(key, "empty; {advice}", advice=advice)
        elif text is not None and not text.isprintable():
            self.add(key, "contains line breaks or non-printable characters; write it as one plain line")
        return text or ""

    def optional_text(self, key: str) -> str | None:
        """Free text; None when it is not given."""
        return self._text(key, LONGEST_NOTE) if self.has(key) else None

    def choice(self, key: str, allowed: tuple[str, ...], instead: str = "") -> str:
        """A required word out of a few; of a bad one the first, or ``instead``."""
        value = self.values.get(key)
        if isinstance(value, str) and value in allowed:
            return value
        problem = say("{value} is unknown", value=shown(value)) if self.has(key) else "missing"
        self.add(key, "{problem}; give one of {values}", problem=problem, values=joined(", ", allowed))
        return instead or allowed[0]

    def number(self, key: str, within: Interval, advice: str) -> float:
        """A required number; NaN stands in for a bad one."""
        if not self.has(key):
            self.add(key, "missing; {advice}", advice=advice)
            return math.nan
        value = self.optional_number(key, within)
        return math.nan if value is None else value

    def optional_number(self, key: str, within: Interval) -> float | None:
        """A number, or None when it is not given or bad."""
        if not self.has(key):
            return None
        value, fault = number_in(self.values[key], within)
        if fault:
            self.add(key, fault)
        return value

    def child(self, key: str) -> "Fields | None":
        """The object under a key; None when it is not given or is something else."""
        value = self.values.get(key)
        if isinstance(value, Mapping):
            return Fields(value, self.place(key), self.problems)
        if value is not None:
            self.add(key, "is {value}; must be an object in braces", value=shown(value))
        return None

    def _text(self, key: str, longest: int) -> str | None:
        value = self.values[key]
        if not isinstance(value, str):
            self.add(key, "is {value}; must be text in quotes", value=shown(value))
            return None
        if UNSTORABLE.search(value) or len(value) > longest:
            self.add(
                key,
                "must be at most {longest} characters of ordinary text, without control characters",
                longest=longest,
            )
            return None
        return value.strip()


def number_in(value: object, within: Interval) -> tuple[float | None, str]:
    """The value as a number of the interval, or None with the fault."""
    if isinstance(value, str):
        return None, say(
            "is the text {value}; write a number, without quotes and with a decimal point", value=shown(value)
        )
    if isinstance(value, bool) or not isinstance(value, NUMBERS):
        return None, say("is {value}; must be a number", value=shown(value))
    number = value if isinstance(value, int | float) else float(value)
    return (float(number), "") if number in within else (None, within.fault(number))
