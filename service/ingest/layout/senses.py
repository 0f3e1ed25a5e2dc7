"""A heading's words → the kind and the axis or number of the sensor that it names."""

import re
from dataclasses import dataclass

from service.ingest.layout.vocabulary import BEGINNINGS, LETTERS, OTHER_THINGS, SHORT, unit_of

WORD = re.compile(r"[A-ZА-ЯЁ]{2,}(?![a-zа-яё])|[A-ZА-ЯЁ]?[a-zäöüßа-яёωµ]+|[A-ZА-ЯЁ]|\d+")
"""A word of a heading, also within ``AccelX`` and ``gyroADC[0]``."""
PLAIN_LETTERS = str.maketrans("éèêâàôûîçё", "eeeaaouice")
AXES = {"x": "X", "y": "Y", "z": "Z", "х": "X", "у": "Y", "з": "Z"}
"""Names of axes, and what Cyrillic letters look or sound like them."""
FUSED = {
    kind: re.compile(rf"(?:{'|'.join(sorted(words.split(), key=len, reverse=True))})_?(?P<axis>[xyzху])")
    for kind, words in SHORT.items()
}
"""``ax``, ``wz``, ``gfx``: kind and axis in one word."""
TURNED = re.compile(r"[rRРр]_?(?P<axis>[xyzXYZху])")
"""``RX``: an angle, or a rate where the values say so."""
NAMED_AXES = {"roll": "x", "pitch": "y", "yaw": "z", "longitudinal": "x", "lateral": "y", "vertical": "z"}
"""Names of axes of a quantity with a unit of acceleration or rate; of another one they are angles and places."""
QUANTITIES = {"acceleration": "accelerometer", "rate": "gyroscope"}
SHORTEST_WORD = 3
"""Letters of a word that means the same anywhere in a heading."""
LONGEST_NUMBER = 3
"""Digits of a sensor's number."""


@dataclass(frozen=True)
class Sense:
    """A sensor that a heading names."""

    kind: str | None
    """``accelerometer`` or ``gyroscope``; None where only an axis is named."""
    place: str
    """``X``, ``Y``, ``Z`` or a number; empty where there is none."""
    group: tuple[str, ...]
    """The other words, which the axes of one device share."""
    unit: str
    """Unit as the heading writes it; empty where it has none."""

    @property
    def letter(self) -> str:
        """The letter that its name begins with."""
        return LETTERS.get(self.kind or "", "")


def words_of(heading: str) -> list[str]:
    """The words of a heading in lower case, without accents."""
    return [word.lower().translate(PLAIN_LETTERS) for word in WORD.findall(heading.replace("º", ""))]


def is_of_another_thing(heading: str) -> bool:
    """Whether a heading speaks of something that is no reading of an accelerometer or a gyroscope."""
    words = words_of(heading)
    compact = "".join(words)
    return any(word.startswith(OTHER_THINGS) for word in words) or compact.startswith(OTHER_THINGS)


def sense_of(name: str, unit: str) -> Sense | None:
    """The sensor that a heading without its unit names; None where it names none."""
    words = words_of(name)
    quantity = getattr(unit_of(unit), "quantity", None) if unit else None
    if quantity in QUANTITIES:
        words = [NAMED_AXES.get(word, word) for word in words]
    is_another = is_of_another_thing(" ".join(words))
    if not words or is_another or quantity not in (None, *QUANTITIES, "count", "voltage", "current"):
        return None
    fused = _fused(name)
    place, group = (fused[1], fused[2]) if fused else _place(words)
    kind = QUANTITIES.get(quantity or "") or (fused[0] if fused else _kind(words, group if place else ()))
    if kind is None and (match := TURNED.fullmatch(name.strip())):
        return Sense(None, AXES[match["axis"].lower()], ("r",), unit)
    if kind is None and (not place or group):
        return None
    return Sense(kind, place, group, unit)


def _kind(words: list[str], group: tuple[str, ...]) -> str | None:
    """Kind of sensor, by the beginning of a word or of the words run together, or by a short word next to an axis."""
    compact = "".join(words)
    for kind, beginnings in BEGINNINGS.items():
        for beginning in beginnings.split():
            if beginning in compact if len(beginning) > 8 else any(word.startswith(beginning) for word in words):
                return kind
    candidates = [word for k, word in enumerate(group) if k == 0 or len(word) >= SHORTEST_WORD]
    return next((kind for word in candidates for kind, short in SHORT.items() if word in short.split()), None)


def _fused(name: str) -> tuple[str, str, tuple[str, ...]] | None:
    """Kind, axis and the other words of a heading with both in its last word: ``IMU0_ax``."""
    parts = [part for part in re.split(r"[\W_]+", name.lower()) if part]
    for place in range(len(parts)):
        for kind, pattern in FUSED.items():
            if match := pattern.fullmatch(parts[place]):
                group = (*parts[:place], parts[place][: match.start("axis")], *parts[place + 1 :])
                return kind, AXES[match["axis"]], group
    return None


def _place(words: list[str]) -> tuple[str, tuple[str, ...]]:
    """The axis, or else the number at the end, and the other words."""
    axes = [k for k, word in enumerate(words) if word in AXES]
    if axes:
        return AXES[words[axes[-1]]], tuple(word for k, word in enumerate(words) if k != axes[-1])
    if words[-1].isdecimal() and len(words[-1]) <= LONGEST_NUMBER:
        return words[-1].lstrip("0") or "0", tuple(words[:-1])
    return "", tuple(words)
