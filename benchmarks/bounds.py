"""``python -m benchmarks.bounds`` writes the numbers that a session file may hold into benchmarks/results/bounds.md."""

from benchmarks.details import RESULTS
from estimator.reading.bounds import BOUNDS

PAGE = RESULTS / "bounds.md"
HEAD = """# Which numbers a session file may hold

Made by `python -m benchmarks.bounds` from `estimator/reading`. Where 0 is taken, so is any number of at least the
smallest size; `stand.sigma_arcsec` means each error that it holds.

| field | unit | from … to | smallest | 0 taken | why |
| --- | --- | --- | --- | --- | --- |
"""


def page() -> str:
    """Markdown: a row a field."""
    return HEAD + "\n".join(bound.row for bound in BOUNDS) + "\n"


def main() -> None:
    """Write the page."""
    PAGE.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
