"""Pages that commands write: ``docs`` has what a reader decides by, ``benchmarks/results`` all that was measured.

A writer marks its long tables with `in_full`; the page leaves them out and links to the whole output.
"""

import os
import re
from pathlib import Path

PROJECT = Path(__file__).parents[1]
DOCS, RESULTS = PROJECT / "docs", PROJECT / "benchmarks" / "results"
BEGIN, END = "<!-- in full only -->", "<!-- end -->"
MARKED = re.compile(rf"\n*{BEGIN}.*?{END}", re.DOTALL)
LINK = re.compile(r"\]\(([^)\s#]+)")


def in_full(text: str) -> str:
    """Marks what stands in the whole output only."""
    return f"{BEGIN}\n\n{text}\n\n{END}"


def publish(text: str, page: Path) -> None:
    """Writes the page, and beside the other results the whole output."""
    whole = whole_of(page)
    whole.parent.mkdir(parents=True, exist_ok=True)
    page.parent.mkdir(parents=True, exist_ok=True)
    whole.write_text(relinked(text, page, whole), encoding="utf-8")
    page.write_text(shortened(text, page), encoding="utf-8")


def published(page: Path) -> str:
    """The whole output of a page, as it was given to `publish`."""
    whole = whole_of(page)
    return relinked(whole.read_text(encoding="utf-8"), whole, page)


def whole_of(page: Path) -> Path:
    """The file with the whole output; of a page outside the documentation the file beside it."""
    if page.is_relative_to(DOCS):
        return RESULTS / page.relative_to(DOCS)
    return page.with_name(f"{page.stem}-in-full.md")


def shortened(text: str, page: Path) -> str:
    """The page: without what is marked, with the link after its first paragraph."""
    title, first, *rest = MARKED.sub("", text).split("\n\n", 2)
    link = f"Every table: [in full]({os.path.relpath(whole_of(page), page.parent)})."
    return "\n\n".join([title, first, link, *rest])


def relinked(text: str, here: Path, there: Path) -> str:
    """Text whose relative links hold in another file."""

    def moved(found: re.Match[str]) -> str:
        if "://" in found[1]:
            return found[0]
        target = os.path.normpath(here.parent / found[1])
        return f"]({os.path.relpath(target, there.parent)}"

    return LINK.sub(moved, text)
