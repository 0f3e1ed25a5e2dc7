"""Is a serial number another one's slip of writing?

Units of a fleet are numbered, so that most of them are one keystroke apart. What distinguishes a slip from the next
unit of the series is which characters differ:

* characters that look alike, capitals and small letters, two encodings of one letter: always a slip;
* one digit for another, or two exchanged: the next unit, as far as the number says;
* a digit more or less: a slip where the number then leaves the series, or is the same one with a zero before it;
* a letter or mark for another, one more, one less, two exchanged: a slip, unless the fleet has several letters there.
"""

import unicodedata
from collections.abc import Collection, Iterable

DIGITS = frozenset("0123456789")
LEAST_SPAN = 30
"""Numbers by which a series of few known units may go on: the units that one order brings."""
SHORTEST = 6
"""Characters of a serial number from which on one keystroke can be a slip: of a shorter one it is as often another
unit."""
SEVERAL = 2
"""Letters at one place, from which on they tell units apart as digits do."""
CYRILLIC = dict(
    zip(
        "\u0430\u0432\u0441\u0435\u043d\u0456\u0458\u043a\u043c\u043e\u0440\u0455\u0442\u0443\u0445",
        "abcehljkmopstyx",
        strict=True,
    )
)
"""Small letters that look like Latin ones, as small letters or as capitals."""
GREEK = dict(
    zip(
        "\u03b1\u03b2\u03b5\u03b7\u03b9\u03ba\u03bc\u03bd\u03bf\u03c1\u03c4\u03c5\u03c7\u03b6",
        "abehlkmnoptyxz",
        strict=True,
    )
)
LOOK_ALIKES = str.maketrans({**CYRILLIC, **GREEK, "0": "o", "1": "l", "i": "l", "|": "l"})
"""What is read for one another, as far as keyboards in use have it (of Unicode TS 39)."""


def folded(serial: str) -> str:
    """The same for all serial numbers that are read for one another: without case, encoding, kind of dash or space."""
    plain = unicodedata.normalize("NFKC", serial).casefold().translate(LOOK_ALIKES)
    return "".join("-" if unicodedata.category(c) == "Pd" else c for c in plain if not c.isspace())


def is_one_keystroke(one: str, other: str) -> bool:
    """Whether one character was written for another, left out or added, or two beside one another exchanged; of serial
    numbers that are long enough to tell."""
    a, b, _ = _difference(one, other)
    if max(len(one), len(other)) < SHORTEST:
        return False
    return sorted((len(a), len(b))) in ([0, 1], [1, 1]) or (len(a) == 2 and a == b[::-1])


def is_slip(new: str, known: str, fleet: Collection[str]) -> bool:
    """Whether a new serial number that is one keystroke from a known one is rather a slip than the next of the fleet's
    series; ``fleet`` are the serial numbers of the type's known units."""
    a, b, place = _difference(new, known)
    if len(a) == len(b):
        return not DIGITS.issuperset(a + b) and not (len(a) == 1 and _tells_apart(new, place, fleet))
    return not DIGITS.issuperset(a + b) or _leaves_series(new, known, place, fleet)


def _difference(one: str, other: str) -> tuple[str, str, int]:
    """What lies between the same beginning and the same end of both, and where."""
    start = next((i for i, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), min(len(one), len(other)))
    rest = list(zip(one[start:][::-1], other[start:][::-1], strict=False))
    end = next((i for i, (a, b) in enumerate(rest) if a != b), len(rest))
    return one[start : len(one) - end], other[start : len(other) - end], start


def _tells_apart(new: str, place: int, fleet: Iterable[str]) -> bool:
    """Whether units of the fleet differ by a letter at a place."""
    frame = _frame(new, place)
    letters = {one[place] for one in fleet if len(one) == len(new) and _frame(one, place) == frame}
    return len(letters - DIGITS) >= SEVERAL


def _frame(serial: str, place: int) -> str:
    """What is beside a place, whichever the numbers."""
    return "".join("?" if i == place else "9" if c in DIGITS else c for i, c in enumerate(serial))


def _leaves_series(new: str, known: str, place: int, fleet: Iterable[str]) -> bool:
    """Whether a number with a digit more or less is none that the series would have."""
    head, number, tail = _around(new, place)
    own = known[len(head) : len(known) - len(tail)]
    if not number or not own or int(number) == int(own):
        return True
    heads = (one[len(head) : len(one) - len(tail)] for one in fleet if one.startswith(head) and one.endswith(tail))
    numbers = [int(run) for run in heads if run and DIGITS.issuperset(run)]
    span = max(max(numbers) - min(numbers), LEAST_SPAN)
    return not min(numbers) - span <= int(number) <= max(numbers) + span


def _around(serial: str, place: int) -> tuple[str, str, str]:
    """What stands before, in and behind the run of digits at a place."""
    start, end = place, place
    while start > 0 and serial[start - 1] in DIGITS:
        start -= 1
    while end < len(serial) and serial[end] in DIGITS:
        end += 1
    return serial[:start], serial[start:end], serial[end:]
