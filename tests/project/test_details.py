"""Pages that commands write: the page is the whole output without its long tables, and leads to it."""

from pathlib import Path

import pytest

from benchmarks.details import BEGIN, DOCS, RESULTS, in_full, publish, published, shortened

WHOLE = sorted(p.relative_to(RESULTS) for p in RESULTS.rglob("*.md") if BEGIN in p.read_text(encoding="utf-8"))
TEXT = f"# Title\n\nMade [so](other.md).\n\n| short |\n\n{in_full('| long |')}\n\nThe end.\n"


@pytest.mark.parametrize("name", WHOLE, ids=str)
def test_a_page_is_its_whole_output_without_the_long_tables(name: Path) -> None:
    page = DOCS / name
    assert page.read_text(encoding="utf-8") == shortened(published(page), page)


def test_what_is_marked_stands_in_the_whole_output_only(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    publish(TEXT, page)
    assert page.read_text(encoding="utf-8") == (
        "# Title\n\nMade [so](other.md).\n\nEvery table: [in full](page-in-full.md).\n\n| short |\n\nThe end.\n"
    )
    assert published(page) == TEXT


def test_links_of_the_whole_output_lead_where_those_of_the_page_do() -> None:
    whole = RESULTS / "diagnosis" / "open-world.md"
    assert "[inside them](../../../docs/diagnosis/study.md)" in whole.read_text(encoding="utf-8")
