"""The site of the documentation: every page is found in it, every link leads somewhere. `make docs` builds it whole."""

import os
import re
from pathlib import Path

import pytest

import estimator
from docs.site.command_line import command_line_page
from docs.site.http import http_page
from docs.site.navigation import configuration, entries, title
from docs.site.python import python_page
from docs.site.staging import stage
from service import client
from service.app import create_app
from service.commands.catalogue import CATALOGUE
from service.settings import Settings

ROOT = Path(__file__).parents[2]
MADE = {"reference/command-line.md": ("Every command: as its help says it", "# Every command\n")}
LINK = re.compile(r"\]\(([^)\s#]*)(?:#([^)\s]*))?\)")
HEADING = re.compile(r"^#{1,6} (.+)$", re.MULTILINE)


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The pages as the generator takes them, with one that is made from the code."""
    folder = tmp_path_factory.mktemp("site") / "pages"
    stage(ROOT, folder, MADE)
    return folder


def links(page: Path) -> list[tuple[Path, str]]:
    """Files that a page links to, with the anchors."""
    text = re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text("utf-8"), flags=re.DOTALL)
    inside = [pair for pair in LINK.findall(text) if "://" not in pair[0] and not pair[0].startswith("mailto:")]
    return [(Path(os.path.normpath(page.parent / target)) if target else page, anchor) for target, anchor in inside]


def anchors(page: Path) -> set[str]:
    """Anchors of a page as the generator makes them of the headings."""
    bare = (
        re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", found).lower() for found in HEADING.findall(page.read_text("utf-8"))
    )
    return {re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", found).strip()) for found in bare}


def test_every_link_leads_to_a_page_and_its_heading(pages: Path) -> None:
    wrong = [
        f"{page.relative_to(pages)} → {target.name}#{anchor}"
        for page in pages.rglob("*.md")
        for target, anchor in links(page)
        if not target.exists() or (anchor and target.suffix == ".md" and anchor not in anchors(target))
    ]
    assert wrong == []


def test_every_page_is_reached_from_the_navigation(pages: Path) -> None:
    reached = {pages / path for _, found in entries(pages) for _, path in found} | {pages / "index.md"}
    todo = list(reached)
    while todo:
        new = {target for target, _ in links(todo.pop()) if target.suffix == ".md"} - reached
        reached |= new
        todo += new
    assert set(pages.rglob("*.md")) - reached == set()


def test_the_navigation_is_what_somebody_learns_does_looks_up_and_understands(pages: Path) -> None:
    sections = dict(entries(pages))
    assert list(sections)[:4] == ["Tutorial", "How to", "Reference", "Methods"]
    assert sections["Reference"][0] == ("Every command", "reference/command-line.md")
    text = configuration(entries(pages))
    assert all(f'"{path}"' in text for found in sections.values() for _, path in found)
    assert title(pages / "index.md") == "Documentation"


def test_the_reference_has_every_command_call_and_public_name(tmp_path: Path) -> None:
    described = create_app(Settings(data_folder=tmp_path)).openapi()
    commands, http = command_line_page(), http_page(described)
    assert [name for name in CATALOGUE if f"## {name}\n" not in commands] == []
    assert [path for path in described["paths"] if f"`{path}`" not in http] == []
    for package in (estimator, client):
        page = python_page(package)
        assert [name for name in package.__all__ if f"## `{name}`\n" not in page] == []
