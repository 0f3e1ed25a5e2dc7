"""How one English text is read as messages of a catalogue: as one, as one within another, or as several joined."""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import chain
from typing import Protocol

from service.languages.message import PLACE
from service.languages.pattern import HEAD, LEAD, LEADS, TAIL, Pattern, is_closed

ENGLISH = re.compile(r"(?<![\w.'/’-])(?!(?:ppm|arcsec|rad|min|acc|imu-health)\b)[A-Z]?[a-z]{2,}(?![\w/]|\.\w|-\d)")
"""A word, and no unit, identifier or name of a file."""
UNTOLD = re.compile(r"(?<!\S)(?!(?:ppm|arcsec|rad|min|acc)\b)[a-z]{2,}")
"""Where a part has a word that is no name."""
SENTENCES = re.compile(r"(?<=[.!?]) (?=[A-Z“])")
BRACKETS = re.compile(r"(.+?)( ?\()(.+?)(\))(.*)", re.DOTALL)
JOINTS = ("; ", ": ", ", ", " and ", " or ", " ")
"""Where a text is taken apart, the strongest first."""
STRONG = ("; ", ": ")
"""Joints between what are sentences by themselves: one may be told without the other."""
TORN = ("; ", ". ")
"""What a value in the midst of a sentence rarely holds."""
WORSE = 4
"""Messages that a reading with such a value counts for in addition."""
ENDS = ".,:;…!"
DEEPEST = 16
"""Messages within messages: what is said to people is not nested deeper."""
MOST_READ = 500
"""Parts of one text that are read: three times what the longest sentence has; somebody may write one to take time."""
MOST_PARTS = 24
"""Of a text: what has more is a list of names or what somebody wrote."""
MOST_WORDS = 4
"""That are told word by word, ``A1 bias``."""


@dataclass(frozen=True)
class Reading:
    """A text as it is understood."""

    untold: int
    """Letters of words that stay English."""
    messages: int
    said: str
    sure: bool = False
    """Whether no other is worth looking for."""

    @property
    def rank(self) -> tuple[int, int]:
        """The smaller the better."""
        return self.untold, self.messages


class Words(Protocol):
    """What a catalogue knows."""

    settled: dict[str, Reading]

    def settle(self, text: str, reading: Reading) -> None: ...
    def exact(self, text: str) -> str: ...
    def candidates(self, text: str) -> Iterator[tuple[Pattern, dict[str, str]]]: ...
    def form(self, pattern: Pattern, values: Mapping[str, str]) -> str: ...
    def joint(self, english: str) -> str: ...


class Reader:
    """One text and all that it is made of, each part read once."""

    def __init__(self, of: Words, known: dict[str, Reading]) -> None:
        self._of, self._known, self._left = of, known, MOST_READ

    def read(self, text: str, depth: int = 0) -> Reading:
        """The best reading."""
        if found := self._of.settled.get(text) or self._known.get(text):
            return found
        letters = sum(map(len, ENGLISH.findall(text)))
        best = Reading(letters, 0, text)
        if depth >= DEEPEST or self._left == 0:
            return best
        self._left -= 1
        self._known[text] = best
        if letters:
            for reading in self._readings(text, depth):
                best = min(best, reading, key=lambda r: r.rank)
                if best.sure:
                    break
            self._known[text] = best
        if best.sure:
            self._of.settle(text, best)
        return best

    def _readings(self, text: str, depth: int) -> Iterator[Reading]:
        yield from self._as_one(text, depth)
        if text[-1].isalnum():  # a sentence said within another has lost its full stop
            for whole in self._as_one(f"{text}.", depth):
                yield replace(whole, said=whole.said.removesuffix("."))
        yield from self._in_parts(text, depth)

    def _as_one(self, text: str, depth: int) -> Iterator[Reading]:
        """As one message, with or without places; the one with the most words of its own first."""
        if said := self._of.exact(text):
            yield Reading(0, 1, said, sure=True)
            return
        for pattern, values in sorted(self._of.candidates(text), key=lambda found: -found[0].letters):
            reading = self._filled(pattern, text, values, depth)
            if reading.untold == 0 or not pattern.is_vague:
                yield reading
            if reading.sure:
                return

    def _whole(self, text: str, depth: int) -> Reading:
        """As one message; as its own words where it is none."""
        plain = Reading(sum(map(len, ENGLISH.findall(text))), 0, text)
        if depth >= DEEPEST or self._left == 0:
            return plain
        return min(chain((plain,), self._as_one(text, depth)), key=lambda r: r.rank)

    def _filled(self, pattern: Pattern, text: str, values: dict[str, str], depth: int) -> Reading:
        read = {name: self.read(value, depth + 1) for name, value in values.items() if name != LEAD}
        form = self._of.form(pattern, values)
        if LEAD not in values:
            form = form.lstrip(LEADS)
        elif pattern.is_fragment and form[0] not in LEADS:
            form = values[LEAD] + form
        said = PLACE.sub(lambda m: read[m[1]].said if m[1] in read else "", form)
        if HEAD not in read and text[0].isalpha() and pattern.text.lstrip(LEADS)[0].isalpha():
            said = cased(said, text)
        said = f"{read[HEAD].said if HEAD in read else ''}{said}{read[TAIL].said if TAIL in read else ''}"
        joints = JOINTS[:-1] if pattern.is_vague else TORN
        torn = sum(any(j in value for j in joints) for name, value in values.items() if name not in (HEAD, TAIL))
        reading = _sum(read.values(), said, 1 + torn * WORSE)
        return replace(reading, sure=reading.untold == 0 and not torn and not pattern.is_vague)

    def _in_parts(self, text: str, depth: int) -> Iterator[Reading]:
        sentences = SENTENCES.split(text)
        if len(sentences) > 1:
            whole = self._joined(sentences, " ", depth)
            yield replace(whole, sure=whole.untold == 0)
            return
        if text[-1] in ENDS:
            inner = self.read(text[:-1], depth + 1)
            yield Reading(inner.untold, inner.messages, inner.said + text[-1])
        if brackets := BRACKETS.fullmatch(text):
            before, inside, after = (self.read(brackets[k], depth + 1) for k in (1, 3, 5))
            yield _sum((before, inside, after), f"{before.said}{brackets[2]}{inside.said}){after.said}", 0)
        for joint in JOINTS:
            if joint in text:
                yield from self._at(joint, text, depth)

    def _at(self, joint: str, text: str, depth: int) -> Iterator[Reading]:
        parts = outside_brackets(text, joint)
        if len(parts) < 2 or len(parts) > (MOST_WORDS if joint == " " else MOST_PARTS):
            return
        whole = self._joined(parts, joint, depth)
        if joint in STRONG or whole.untold == 0 or (joint != " " and whole.messages and self._all_told(parts, depth)):
            yield replace(whole, sure=joint in STRONG and whole.untold == 0)

    def _all_told(self, parts: list[str], depth: int) -> bool:
        """Whether something of every part is told, or it is a name."""
        return all(self.read(p, depth + 1).said != p or not UNTOLD.search(p) for p in parts)

    def _joined(self, parts: list[str], joint: str, depth: int) -> Reading:
        """The best way to put neighbours together: what is one message stays one."""
        best = [Reading(0, 0, "")]
        said = self._of.joint(joint)
        for end in range(1, len(parts) + 1):
            ways = []
            for start in range(max(0, end - 3), end):
                text = joint.join(parts[start:end])
                if end - start == len(parts):
                    continue
                one = self.read(text, depth + 1) if end - start == 1 else self._whole(text, depth + 1)
                before = best[start]
                ways.append(_sum((before, one), f"{before.said}{said if start else ''}{one.said}", 0))
            best.append(min(ways, key=lambda r: r.rank))
        return best[-1]


def _sum(parts: Iterable[Reading], said: str, messages: int) -> Reading:
    counted = list(parts)
    return Reading(sum(p.untold for p in counted), messages + sum(p.messages for p in counted), said)


def outside_brackets(text: str, joint: str) -> list[str]:
    """The parts of a text between joints that stand in no brackets."""
    parts = list[str]()
    for part in text.split(joint):
        if parts and not is_closed(parts[-1]):
            parts[-1] += joint + part
        else:
            parts.append(part)
    return parts


def cased(said: str, like: str) -> str:
    """With a first letter as large as another text's."""
    if like[0].isupper():
        return said[0].upper() + said[1:]
    return said if said[1:2].isupper() else said[0].lower() + said[1:]
