"""docs/architecture.md draws the imports as they are held, and what it names is there."""

import re
from pathlib import Path

import pytest

from service.settings import Settings
from tests.project.source import ROOT
from tests.project.test_imports import ESTIMATOR_LAYERS, SERVICE_LAYERS

PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
PAGES = (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md")))
ROOMS = "estimator|service|tests|migrations|benchmarks|docker|docs"


def drawn(heading: str) -> list[set[str]]:
    """The rooms of a drawing, the lowest first, without what lies outside the package."""
    line = re.search(rf"^{heading}:\n\n    (.*)$", PAGE, re.MULTILINE)
    assert line is not None
    return [set(re.split(r" \| |, ", rooms)) for rooms in reversed(line.group(1).split(" → "))][1:]


@pytest.mark.parametrize(("heading", "layers"), [("The service", SERVICE_LAYERS), ("The estimator", ESTIMATOR_LAYERS)])
def test_the_imports_are_drawn_as_they_are_held(heading: str, layers: tuple[set[str], ...]) -> None:
    assert drawn(heading) == list(layers)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_file_that_a_page_names_is_there(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    named = re.findall(rf"`((?:{ROOMS})/[\w./-]+)`", text)
    written = re.findall(r"new file `([^`]+)`:", text)  # by the reader of a how-to
    assert [path for path in named if path not in written and not (ROOT / path).exists()] == []


def test_every_setting_is_in_the_table_of_settings() -> None:
    table = (ROOT / "docs" / "settings.md").read_text(encoding="utf-8")
    named = re.findall(r"^\| `IMU_HEALTH_([A-Z_]+)` \|", table, re.MULTILINE)
    assert sorted(named) == sorted(name.upper() for name in Settings.model_fields)
