"""``python -m benchmarks.fleet.million`` writes what fleets cost into benchmarks/results/how-to/large-fleets.md.

Nothing is measured here: the figures come from the tables that `benchmarks.fleet.bytes` and `make bench` wrote, and the
rest is arithmetic, of which every assumption stands in the head of this file.
"""

import re
from collections.abc import Iterator

from benchmarks.details import PROJECT, RESULTS
from benchmarks.sections import write_section

PAGE, MEASURED = RESULTS / "how-to" / "large-fleets.md", PROJECT / "benchmarks" / "RESULTS.md"
GUIDE = PROJECT / "docs" / "how-to" / "large-fleets.md"
STORED = re.compile(r"([\d,]+) bytes of tables and ([\d,]+) of the uploaded file")
MARK = "<!-- written by python -m benchmarks.fleet.million -->"
FLEETS = (1_000, 10_000, 100_000, 1_000_000)
SESSIONS_A_YEAR = 2.0
"""Calibrations of a unit: every half a year."""
WORKING = 250 * 8 * 3600.0
"""s of a year in which workshops upload."""
PEAK = 5.0
"""Times the mean of working hours: a Monday morning."""
BUSY = 0.5
"""Share of a core that work may take before waiting grows."""
KEPT_YEARS = 10.0
GIGA = 1e9


def seconds(row: str) -> float:
    """The time of a row of the benchmarks' table."""
    own = rf"^\| {re.escape(row)} \|[^|]*\| ([\d.e+]+) (m?s) \|"
    found = re.search(own, MEASURED.read_text(encoding="utf-8"), re.M)
    assert found is not None, f"{MEASURED} has no row {row}"
    return float(found[1]) * {"ms": 1e-3, "s": 1.0}[found[2]]


def bytes_a_session() -> tuple[float, float]:
    """Bytes of a session in tables and in its uploaded file, as the guide states them."""
    found = STORED.search(GUIDE.read_text(encoding="utf-8"))
    assert found is not None, f"{GUIDE} states no bytes of a session"
    tables, file = (float(number.replace(",", "")) for number in found.groups())
    return tables, file


def lines() -> Iterator[str]:
    """The table, a fleet a column."""
    upload, diagnosis = seconds("U2, 1 client"), seconds("P4h, new")
    stored, file = bytes_a_session()
    rates = [units * SESSIONS_A_YEAR * PEAK / WORKING for units in FLEETS]
    sessions = [units * SESSIONS_A_YEAR * KEPT_YEARS for units in FLEETS]
    yield f"| units | {' | '.join(f'{units:,}' for units in FLEETS)} |"
    yield f"| --- | {' | '.join('---' for _ in FLEETS)} |"
    yield from (
        f"| {what} | {' | '.join(form.format(value) for value in values)} |"
        for what, form, values in (
            ("uploads a second at the peak", "{:.2g}", rates),
            ("cores that answer them", "{:.2g}", [rate * upload / BUSY for rate in rates]),
            ("cores that diagnose beside", "{:.2g}", [rate * diagnosis / BUSY for rate in rates]),
            ("database after ten years, GB", "{:,.3g}", [n * stored / GIGA for n in sessions]),
            ("files after ten years, GB", "{:,.3g}", [n * file / GIGA for n in sessions]),
            ("all sessions diagnosed anew, core hours", "{:,.3g}", [n * diagnosis / 3600 for n in sessions]),
        )
    )


def main() -> None:
    """Writes the section."""
    text = "\n".join(lines())
    write_section(PAGE, MARK, text)
    print(text)


if __name__ == "__main__":
    main()
