"""Title rows above a table → the facts of the session stated there: serial number, date and time, stand, operator."""

import re
from collections.abc import Iterator, Sequence
from datetime import datetime, timedelta

from estimator.json_object import Json

KEYS = {
    "unit": r"serial(?: ?(?:no|nr|number))?|s/n|unit|serien-?(?:nr|nummer)|geräte?-?nr|prüfling"
    r"|(?:зав|заводской|сер|серийный)\.? ?(?:номер|№)|прибор|изделие|блок",
    "day": r"date|measured(?: on)?|datum|messdatum|дата(?: измерени[йя])?",
    "clock": r"time|start|uhrzeit|beginn|время|начало",
    "stand": r"stand|test stand|prüfstand|messplatz|стенд|установка",
    "operator": r"operator|measured by|bearbeiter|prüfer|оператор|исполнитель|измерил",
}
"""Beginnings of titles, in English, German and Russian."""
TITLE = {
    key: re.compile(rf"(?:{words})(?:(?<=№)|(?!\w))\.?(?: ?(?:№|#|no\.|nr\.))?(?P<mark> ?[:=])?(?P<rest>.*)", re.I)
    for key, words in KEYS.items()
}
NAME, NUMBER, PERSON = re.compile(r"[^\s:=]*\d[^\s:=]*$"), re.compile(r"\d"), re.compile(r"[^\W\d_][^:=]*$")
VALUE = {"unit": NAME, "day": NUMBER, "clock": NUMBER, "stand": NAME, "operator": PERSON}
"""Values that need no colon before them: ``Stand ODG-1``."""
DAY = re.compile(r"(?P<y>\d{4})-(?P<m>\d\d)-(?P<d>\d\d)|(?P<d2>\d\d?)\.(?P<m2>\d\d?)\.(?P<y2>\d{4})")
CLOCK = re.compile(
    r"(?P<h>\d\d?):(?P<m>\d\d)(?::\d\d(?:[.,]\d+)?)?(?: ?(?:UTC|GMT)? ?(?P<z>[+−-]\d\d?(?::?[0-5]\d)?))?"
)
ZONED = re.compile(r"UTC|GMT|\dT\d")
SPREADSHEET_DAYS = range(30_000, 80_000)
"""Numbers that a date cell has: days since the end of 1899."""
LONGEST = 100
"""Characters of a title that is looked at."""
RATE_NAMES = ("fs", "rate", "samplerate", "sample_rate", "sampling_rate", "samplingrate", "sample_rate_hz", "frequency")
"""Names of a variable that holds the samples a second."""
LONGEST_RATE = 300
"""Characters of a row in which a sample rate is looked for."""
RATE = re.compile(
    r"(?:rate|frequenc[ye]|freq|frequenz|fréquence|cadence|частота\w*|sampl\w+|\bat)\W{0,3}"
    r"(?:[(\[]?(?:hz|гц)[)\]]?\W{0,3}(?P<bare>\d+(?:[.,]\d+)?)"
    r"|(?P<number>\d+(?:[.,]\d+)?) ?(?P<times>[kк]?)(?:hz|гц|sps)\b)",
    re.I,
)
"""Samples a second: ``data_rate = 100.0 Hz``, ``Abtastfrequenz (Hz): 100``."""


def stated_in(rows: Sequence[Sequence[str | float | None]]) -> Json:
    """Fields of imu-session/1 that the title rows state."""
    found: dict[str, str] = {}
    for key, value in _pairs(rows):
        found.setdefault(key, value)
    facts: Json = {key: found[key] for key in ("unit", "operator") if key in found}
    if "stand" in found:
        facts["stand"] = {"id": found["stand"]}
    day, clock = found.get("day", ""), found.get("clock", "")
    start = _start(day or clock, clock or day)
    rates = {rate for row in rows if (rate := _rate(row)) is not None}
    facts |= {"sample_rate_hz": rates.pop()} if len(rates) == 1 else {}
    return facts | ({"started_at": start} if start else {})


def _rate(row: Sequence[str | float | None]) -> float | None:
    """The samples a second that a row states."""
    if len(row) == 2 and isinstance(row[0], str) and isinstance(row[1], float | int) and row[0].lower() in RATE_NAMES:
        return float(row[1]) or None
    match = RATE.search(" ".join(str(cell) for cell in row if cell is not None)[:LONGEST_RATE])
    if match is None:
        return None
    rate = float((match["bare"] or match["number"]).replace(",", ".")) * (1e3 if match["times"] else 1.0)
    return rate or None


def _pairs(rows: Sequence[Sequence[str | float | None]]) -> Iterator[tuple[str, str]]:
    for row in rows:
        cells = [cell.strip() if isinstance(cell, str) else f"{cell:.15g}" for cell in row if cell is not None]
        for cell, following in zip(cells, (*cells, "")[1:], strict=True):
            for key, title in TITLE.items():
                match = title.fullmatch(cell[:LONGEST])
                if match is None:
                    continue
                rest = match["rest"].strip()
                value = rest or following
                if value and (match["mark"] or not rest or VALUE[key].match(rest)):
                    yield key, value


def _start(day_text: str, clock_text: str) -> str:
    """``2026-05-03T09:30:00+05:30``; noon UTC where only the day is stated, empty where not even that."""
    match, clock = DAY.search(day_text), CLOCK.search(clock_text)
    try:
        if match:
            day = datetime(
                int(match["y"] or match["y2"]), int(match["m"] or match["m2"]), int(match["d"] or match["d2"])
            )
        else:
            count = float(day_text)
            day = datetime(1899, 12, 30) + timedelta(days=count if int(count) in SPREADSHEET_DAYS else 1e9)
    except (ValueError, OverflowError):
        return ""
    if clock is None:
        return f"{day:%Y-%m-%d}T12:00:00Z"
    return f"{day:%Y-%m-%d}T{clock['h']:0>2}:{clock['m']}:00{_offset(clock['z'] or '', clock_text)}"


def _offset(zone: str, text: str) -> str:
    """The offset of a zone: ``+05:30``. A part after a minus sign may be the end of the session, unless it is named as
    a zone.
    """
    if not zone or (zone[0] != "+" and not ZONED.search(text)):
        return "Z"
    digits = re.sub(r"\D", "", zone)
    hours, minutes = (digits[:-2], digits[-2:]) if len(digits) > 2 else (digits, "00")
    return f"{'+' if zone[0] == '+' else '-'}{hours:0>2}:{minutes}"
