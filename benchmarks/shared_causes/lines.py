"""Lines of tables on pages: which stand on the page of all targets, and which of them miss theirs, and why."""

import re
from collections.abc import Iterator, Sequence

from benchmarks.details import DOCS, RESULTS, published
from benchmarks.shared_causes.unlike import Line
from benchmarks.study.report import table

PAGE = DOCS / "diagnosis" / "shared-causes.md"
OTHERS = {"shared courses": "shared.md", "temperature": "temperature.md", "noise of means": "../methods/noise.md"}
TITLES = {
    "recordings": "Recordings",
    "departing": "Departures from a course",
    "tails": "Errors with tails",
    "noisier": "Unequal noise",
    "gain": "Gain in one sentence",
    "history": "A unit with earlier sessions",
}
RESTS = "block, tilt"
"""Head of the table of `benchmarks.rests`."""
WHY = {
    "kth exp_1": "Its gyros settle with several time constants: some follow one, others have names of their own.",
    "one shared course": "Slow rooms and ramps: biases that wander each by itself are about as likely.",
    "the same, where an oracle": "The same; the oracle knows the course and lacks only the sizes.",
    "the same: one time constant": "Time constants that happen to lie close together.",
    "sound, ": "Large errors that fall together look like a step, or like one noisier sensor: the first is listed "
    "beside single readings. An oracle that knows the law of the errors names none.",
    "stated errors over true ones, gyro bias": "A rotation that gyros share counts as the noise of each: its slow part "
    "cannot be separated from theirs within the rests.",
    "95 % intervals": "Slow flicker within the rests, whose spectrum three sensors hardly determine.",
    "the course and that sensor": "What a zero settles to is hardly known while it settles: its sensor seems to depart "
    "from the course, by a time constant or a ramp of its own.",
    "these called changed": "A zero that changed before the session looks like one that jumps or settles in its first "
    "rows: one name comes first, the other is listed beside it.",
    "times noisier": "A pattern or a smooth course is about as likely as noise in twenty-four rows.",
    "time of a diagnosis": "A course is weighed against each sensor's own, against wandering biases and in every fold.",
    "seasons, line: units flagged": "One unit of twenty.",
    "`bias-temperature-curve`, 5": "The line is named where the bend is the smaller part.",
    "`scale-temperature-curve`, 5": "The line is named where the bend is the smaller part.",
    "`scale-temperature`, 5": "One session of thirteen.",
}
"""Words of lines, and why these miss their targets where they do."""


def sections(text: str) -> dict[str, str]:
    """The parts that a page holds, by their headings."""
    found = re.findall(r"^## (\w+)\n\n(.*?)(?=^## |^<!-- end|\Z)", text, re.MULTILINE | re.DOTALL)
    return {part: body.strip() for part, body in found}


def read(text: str) -> Iterator[Line]:
    """The lines of the tables with a target."""
    for block in text.split("\n\n"):
        rows = [[cell.strip() for cell in row.strip("|").split(" | ")] for row in block.strip().splitlines()]
        if len(rows) > 1 and [cell.strip() for cell in rows[0]][-2:] == ["target", "measured"]:
            yield from ((words, target, measured) for words, target, measured in rows[2:])


def head(kept: dict[str, str]) -> str:
    """The tables of all targets, then each reason once."""
    groups = {TITLES[part]: read(body) for part, body in kept.items() if part in TITLES}
    for name, path in list(OTHERS.items())[:2]:
        groups[name.capitalize()] = read(published(DOCS / "diagnosis" / path))
    groups["Raw logs by hand"] = rests()
    reasons: list[str] = []
    tables = [f"## {group}\n\n{asked(list(filter(is_asked, lines)), reasons)}" for group, lines in groups.items()]
    numbered = "\n".join(f"{number}. {why}" for number, why in enumerate(reasons, 1))
    return "\n\n".join([*tables, f"## Why\n\n{numbered}"])


def is_asked(line: Line) -> bool:
    """Whether a line has a target that applies to it."""
    words, target, _ = line
    return bool(target) and ("at" not in target or target.split()[-1] in words.split())


def asked(lines: Sequence[Line], reasons: list[str]) -> str:
    """One line a case where the same is asked of every case, else one line a target."""
    parts = [
        (words.partition(": "), target, with_reason((words, target, measured), reasons))
        for words, target, measured in lines
    ]
    cases = list(dict.fromkeys(case for (case, _, _), _, _ in parts))
    columns = list(dict.fromkeys((of, target) for (_, _, of), target, _ in parts))
    if len(cases) == 1 or len(cases) * len(columns) != len(parts):
        return table(("", "target", "measured"), [("".join(words), target, cell) for words, target, cell in parts])
    cells = [cell for _, _, cell in parts]
    rows = [(case, *cells[k * len(columns) : (k + 1) * len(columns)]) for k, case in enumerate(cases)]
    return table(("", *(f"{of}, {target}" for of, target in columns)), rows)


def with_reason(line: Line, reasons: list[str]) -> str:
    """The measured value; where it misses its target, with the number of its reason."""
    words, target, measured = line
    verdict = verdict_of(target, measured)
    why = next((reason for part, reason in WHY.items() if part in words), "")
    if not verdict or not why:
        return f"{measured}, *{verdict}*" if verdict else measured
    if why not in reasons:
        reasons.append(why)
    return f"{measured}, *{verdict}* {reasons.index(why) + 1}"


def rests() -> Iterator[Line]:
    """Stated errors over true ones and what U covers, from the table that `benchmarks.rests` prints."""
    tables = [p.read_text(encoding="utf-8") for p in sorted((RESULTS / "methods").glob("*.md"))]
    found = [block for text in tables for block in text.split("\n\n") if block.startswith(f"| {RESTS}")]
    if not found:
        yield "stated errors over true ones, raw logs by hand", "0.7–1.4", "by `python -m benchmarks.rests`"
    for block in found[:1]:
        titles, _, *rows = [[cell.strip() for cell in row.strip("|").split("|")] for row in block.splitlines()]
        for row in rows:
            for column in (titles.index("mean"), titles.index("gyro bias")):
                yield f"{row[0]}: stated errors over true ones, {titles[column]}", "0.7–1.4", row[column]
            yield f"{row[0]}: {titles[-1]}", "93–97 %", row[-1]


def verdict_of(target: str, measured: str) -> str:
    """Whether the measured value misses its target; for a rate also by its interval."""
    least, most = bounds(target)
    rate = re.match(r"([\d.]+) % \(([\d.]+)[–a-z ]+([\d.]+)\)", measured)
    spread = re.fullmatch(r"([\d.]+) ± ([\d.]+)", measured)
    if rate or spread:
        value, low, high = map(float, rate.groups()) if rate else _interval(measured)
        return "missed" if low > most or high < least else "open" if not least <= value <= most else ""
    bare = re.sub(r"\([^()]*\)", "", re.sub(r"\([^()]*\)", "", measured))
    values = [float(x) for x in re.findall(r"\d+(?:\.\d+)?", bare)]
    if measured.startswith("no course"):
        return "missed"
    return "missed" if values and not (least <= min(values) and max(values) <= most) else ""


def _interval(measured: str) -> tuple[float, float, float]:
    """``94.1 ± 1.7`` and its ends."""
    value, half = map(float, measured.split(" ± "))
    return value, value - half, value + half


def bounds(target: str) -> tuple[float, float]:
    """Least and most that a target allows."""
    numbers = [float(x) for x in re.findall(r"\d+(?:\.\d+)?", target)]
    if target.startswith("≤") or target == "0":
        return float("-inf"), numbers[0]
    if target == "all":
        return 100.0, 100.0
    if target.startswith("≥"):
        return numbers[0], float("inf")
    return (numbers[0], numbers[1]) if len(numbers) > 1 else (float("-inf"), float("inf"))
