"""Every figure that the README boasts of stands in the page that it links to, and the page names the command."""

import re
from pathlib import Path

import pytest

from benchmarks.details import whole_of

ROOT = Path(__file__).parents[2]
TOP = (ROOT / "README.md").read_text("utf-8").split("\n## Start")[0]
ROW = re.compile(
    r"^\| (?P<evidence>.*\]\((?P<page>[^)#]+)\)) \| (?P<figure>.*) \| `(?P<command>[^`]+)` \|$", re.MULTILINE
)
EVIDENCE = {found["page"]: found for found in ROW.finditer(TOP)}
RATE = re.compile(r"(?P<percent>[\d.]+) % \([\d.]+–[\d.]+\) of (?P<trials>\d+)")
LINKED = re.compile(r"\[([^\]]*)\]\(([^)#]+)(#[^)]*)?\)")


def rate(page: str, row: str) -> str:
    """``99.4 % of 483``: a share of a page's table without its interval."""
    [line] = [line for line in (ROOT / page).read_text("utf-8").splitlines() if line.startswith(f"| {row} |")]
    found = RATE.search(line)
    assert found is not None, line
    return f"{found['percent']} % of {found['trials']}"


def rows(page: str) -> str:
    """Number of causes in the tables of a page."""
    return str(len(re.findall(r"^\| `[a-z-]+` \|", (ROOT / page).read_text("utf-8"), re.MULTILINE)))


STUDY = "docs/diagnosis/study.md"
FIGURES = {
    ("docs/diagnosis/causes.md", "a catalogue of 44"): lambda page: f"a catalogue of {rows(page)}",
    (STUDY, "99.4 % of 483"): lambda page: rate(page, "named first where separated by 5"),
    (STUDY, "0.5 % of 199"): lambda page: rate(page, "a name where there is no effect"),
}
"""Figures in the README's links, and what the linked page says."""


@pytest.mark.parametrize(("page", "figure"), FIGURES)
def test_a_figure_stands_in_the_page_that_it_links_to(page: str, figure: str) -> None:
    assert (figure, page) in {(text, target) for text, target, _ in LINKED.findall(TOP)}
    assert FIGURES[page, figure](page) == figure


def test_no_figure_stands_without_a_page_to_look_it_up() -> None:
    own = LINKED.sub("", re.sub(r"`[^`]*`|\]\([^)]*\.png\)", "", TOP))
    assert re.findall(r"\d+(?: of \d+)?", own.replace("separated from every rival by 5", "")) == []
    linked = [(target, text) for text, target, _ in LINKED.findall(TOP) if re.search(r"\d", text)]
    headings = {
        (page, text)
        for page, text in linked
        if EVIDENCE.get(page, {"evidence": ""})["evidence"].startswith(f"[{text}]")
    }
    assert set(linked) - headings == set(FIGURES)


@pytest.mark.parametrize("page", EVIDENCE)
def test_a_page_of_evidence_names_the_command_that_makes_it(page: str) -> None:
    command = EVIDENCE[page]["command"].removeprefix(".venv/bin/")
    pages = (file for file in (ROOT / page, whole_of(ROOT / page)) if file.exists())
    assert any(command in file.read_text("utf-8") for file in pages)
    sessions = re.match(r"\[(\d+) ", EVIDENCE[page]["evidence"])
    assert sessions is None or f"--sessions {sessions[1]} " in command
