"""`python -m benchmarks.licences` writes benchmarks/results/security/licences.md."""

import re
from collections import defaultdict
from importlib.metadata import PackageNotFoundError, metadata

from benchmarks.details import PROJECT, RESULTS

PAGE = RESULTS / "security" / "licences.md"
HEAD = """# Dependencies and their licences

Made by `python -m benchmarks.licences` from `requirements.lock`, `requirements-test.lock` and what the packages say of
themselves. What `make docs` adds (`requirements-docs.lock`: zensical and what it needs) is MIT and BSD,
what `make bench` adds (`requirements-bench.lock`: imucal, pandas and jax) MIT, BSD and Apache.

"""
COLUMNS = "| licence | packages |\n| --- | --- |\n"
ASKS_MORE = re.compile("GPL|MPL|any-OSI|not ")
"""Licences on the page: those that ask for more than naming the authors, and those that are not clear."""
NOT_HERE = "not installed on this kind of machine"


def licence(name: str) -> str:
    """The licence that the package states: an expression, else its classifiers, else the first line of the field."""
    try:
        found = metadata(name)
    except PackageNotFoundError:
        return NOT_HERE
    classifiers = [c.split(" :: ")[-1] for c in found.get_all("Classifier") or () if c.startswith("License ::")]
    text = (found.get("License") or "").strip().split("\n")[0]  # type: ignore[attr-defined]
    stated = found.get("License-Expression") or ", ".join(classifiers) or text or "not stated"  # type: ignore[attr-defined]
    return " ".join(str(stated).split())


def main() -> None:
    """Writes the page."""
    locks = [(PROJECT / name).read_text(encoding="utf-8") for name in ("requirements.lock", "requirements-test.lock")]
    pinned = sorted(name for lock in locks for name in re.findall(r"(?m)^([\w.-]+)==", lock))
    found = defaultdict[str, list[str]](list)
    for name in pinned:
        found[licence(name)].append(name)
    rows = [f"| {stated} | {', '.join(names)} |" for stated, names in sorted(found.items())]
    PAGE.write_text(page_of(rows, len(pinned)), encoding="utf-8")


def page_of(rows: list[str], packages: int) -> str:
    """Markdown, from the rows of the table."""
    asking = [row for row in rows if ASKS_MORE.search(row.split(" | ")[0])]
    words = (
        f"Of {packages} packages these ask for more than MIT, BSD, Apache, ISC and PSF licences do, or are not clear:"
    )
    return "\n\n".join([HEAD.strip(), words, _table(asking), f"## Every package\n\n{_table(rows)}"]) + "\n"


def _table(rows: list[str]) -> str:
    return COLUMNS + "\n".join(rows)


if __name__ == "__main__":
    main()
