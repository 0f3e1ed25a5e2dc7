"""Every command line that people are shown is one that would be taken."""

import re
from pathlib import Path
from typing import Any

import pytest
import typer
from typer.testing import CliRunner

from service.cli import app
from service.commands.catalogue import CATALOGUE
from service.commands.examples import LINES, examples_of
from tests.docs.commands import parsed

ROOT = Path(__file__).parents[2]
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")))
SHOWN = re.compile(r"^```text\n(.*?)^```$", re.DOTALL | re.MULTILINE)
EXAMPLES = [line.partition("  # ")[0] for line in LINES.strip().splitlines()]


def leaves(command: Any, words: str) -> list[str]:
    """Every command below one, itself included."""
    below = getattr(command, "commands", {})
    return [words, *(leaf for name, one in below.items() for leaf in leaves(one, f"{words} {name}"))]


@pytest.mark.parametrize("line", EXAMPLES)
def test_an_example_is_of_the_command_whose_words_it_begins_with(line: str) -> None:
    words = " ".join(parsed(line))
    assert line.startswith(words) or words == "backup write"  # which `backup FILE` is short for


def test_every_command_has_an_example() -> None:
    commands: Any = typer.main.get_command(app)
    every = [leaf for name in CATALOGUE for leaf in leaves(commands.commands[name], name)]
    assert [words for words in every if not examples_of(words)] == []


def test_a_help_ends_with_examples() -> None:
    shown = " ".join(CliRunner().invoke(app, ["token", "revoke", "--help"]).output.split())
    assert shown.endswith("imu-health token revoke 2 — lets nobody in any more")


def test_what_pages_only_show_would_be_taken_too() -> None:
    blocks = (block for page in PAGES for block in SHOWN.findall(page.read_text("utf-8")))
    lines = [line.removeprefix("imu-health ") for block in blocks for line in block.splitlines() if is_whole(line)]
    assert len(lines) > 12
    for line in lines:
        assert parsed(line), line


def is_whole(line: str) -> bool:
    """A command of ours without anything left out."""
    return line.startswith("imu-health ") and "…" not in line
