"""``python -m benchmarks.catalogue`` writes the catalogue of causes into docs/diagnosis/causes.md."""

from collections.abc import Iterable
from pathlib import Path

from estimator.causes import CATALOGUE, ON_TURNTABLE, Cause

PAGE = Path(__file__).parents[1] / "docs" / "diagnosis" / "causes.md"
HEAD = """# The catalogue of causes

Made by `python -m benchmarks.catalogue` from `estimator/causes`. What to do about a cause stands with each finding. a =
e·n is the component of the applied vector n along the input axis e; p and o are unit vectors across it; t is the time
since the start, T the temperature; a bar means the session's mean. Amplitudes are k, in SI; for a gyroscope read rad/s
for m/s². {accepted}
"""
SCOPES = {
    "sensor": "One sensor",
    "environment": "One sensor, with time or temperature",
    "stand": "The stand, common to all sensors",
    "fixture": "The fixture, common to all sensors",
    "record": "The record",
    "gyro": "Gyroscopes",
}


def page() -> str:
    """Markdown: one table a scope."""
    never = ", ".join(f"`{cause.identifier}`" for cause in CATALOGUE if not cause.can_be_modelled)
    parts = [HEAD.format(accepted=f"All but {never} can be accepted into the model of a unit, unit type or stand.")]
    for scope, heading in SCOPES.items():
        rows = [_row(cause) for cause in CATALOGUE if cause.scope == scope]
        parts.append(f"## {heading}\n\n{_line(COLUMNS)}\n{RULE}\n" + "\n".join(rows) + "\n")
    last = "\n".join(map(_row, ON_TURNTABLE))
    parts.append(f"{TURNTABLE}\n\n{_line(COLUMNS)}\n{RULE}\n{last}\n")
    return "\n".join(parts)


TURNTABLE = """## One sensor, on a turntable

Looked for in alignments, where nothing else is. ω is the turn rate, α the angular acceleration, r the sensor's place
from the turn axis."""
COLUMNS = ("identifier", "adds", "unit", "needs", "what it is")
RULE = "| --- | --- | --- | --- | --- |"


def _row(cause: Cause) -> str:
    sentence = cause.sentence.format(sensors="the sensor")
    what = f"{sentence[0].upper()}{sentence[1:]}"
    needs = ", ".join(sorted(cause.needs)) or "–"
    units = ", ".join(dict.fromkeys(cause.units)) or "–"
    return _line((f"`{cause.identifier}`", cause.equation, units, needs, what))


def _line(cells: Iterable[str]) -> str:
    """One line of a table; a bar within a cell is no border."""
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def main() -> None:
    """Write the page."""
    PAGE.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
