"""The navigation of the site is docs/index.md: its headings are the sections, its links the pages, in that order."""

import json
import re
from pathlib import Path

SECTION = re.compile(r"^## (.+)$", re.MULTILINE)
LINKED = re.compile(r"\]\(([^)#\s]+\.md)")
TITLE = re.compile(r"^# (.+)$", re.MULTILINE)
SETTINGS = """[project]
site_name = "imu-health"
site_description = "In-service health monitoring of redundant inertial measurement units"
docs_dir = "docs-source"
site_dir = "docs"
use_directory_urls = false
nav = {nav}

[project.theme]
font = false
language = "en"
features = ["navigation.tabs", "navigation.top", "navigation.footer", "search.highlight", "content.code.copy"]

[[project.theme.palette]]
media = "(prefers-color-scheme)"
toggle.icon = "lucide/sun-moon"
toggle.name = "By the system; choose light"

[[project.theme.palette]]
media = "(prefers-color-scheme: light)"
scheme = "default"
toggle.icon = "lucide/sun"
toggle.name = "Light; choose dark"

[[project.theme.palette]]
media = "(prefers-color-scheme: dark)"
scheme = "slate"
toggle.icon = "lucide/moon"
toggle.name = "Dark; choose the system's"

[project.plugins.offline]
[project.plugins.search]

[project.markdown_extensions.tables]
[project.markdown_extensions.toc]
permalink = true
[project.markdown_extensions.pymdownx.highlight]
[project.markdown_extensions.pymdownx.superfences]
"""
Entry = tuple[str, tuple[tuple[str, str], ...]]
"""A section with its pages, each by title and path."""


def entries(pages: Path) -> tuple[Entry, ...]:
    """Every section of the index with its pages; a page stands where it is named first."""
    seen: set[str] = set()
    found = SECTION.split((pages / "index.md").read_text("utf-8"))
    sections: list[Entry] = []
    for heading, text in zip(found[1::2], found[2::2], strict=True):
        paths = [path for path in dict.fromkeys(LINKED.findall(text)) if "://" not in path and path not in seen]
        seen.update(paths)
        sections.append((heading, tuple((title(pages / path), path) for path in paths)))
    return tuple(sections)


def title(page: Path) -> str:
    """The heading of a page, without marks."""
    found = TITLE.search(page.read_text("utf-8"))
    assert found is not None, f"{page} has no heading"
    return found[1].replace("`", "")


def configuration(sections: tuple[Entry, ...]) -> str:
    """The generator's settings, with the navigation in them."""
    pages = [_table({heading: [_table({name: path}) for name, path in found]}) for heading, found in sections]
    return SETTINGS.format(nav="[" + ", ".join([_table({"Home": "index.md"}), *pages]) + "]")


def _table(pairs: dict[str, str | list[str]]) -> str:
    """As TOML writes a table on one line."""
    return "{ " + ", ".join(f"{json.dumps(name)} = {_value(value)}" for name, value in pairs.items()) + " }"


def _value(value: str | list[str]) -> str:
    return json.dumps(value) if isinstance(value, str) else "[" + ", ".join(value) + "]"
