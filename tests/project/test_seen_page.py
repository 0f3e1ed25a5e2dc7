"""The page of what anybody would see: every part once, in order, with the words that were written by hand."""

import sys
from pathlib import Path
from types import ModuleType

import pytest

from benchmarks.study.seen import __main__ as seen


@pytest.fixture(autouse=True)
def parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two tables that cost nothing."""
    for name in ("flights", "gross"):
        module = ModuleType(f"benchmarks.study.seen.{name}")
        vars(module)["table"] = lambda n, seed: f"| drawn | seed |\n| --- | --- |\n| {n} | {seed} |"
        monkeypatch.setitem(sys.modules, module.__name__, module)
    vars(sys.modules["benchmarks.study.seen.gross"])["TARGET"] = "all of them."


def made(page: Path, monkeypatch: pytest.MonkeyPatch, *arguments: str) -> str:
    monkeypatch.setattr(sys, "argv", ["seen", "--out", str(page), *arguments])
    seen.main()
    return page.read_text("utf-8")


def test_parts_stand_in_order_with_their_targets(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = made(tmp_path / "seen.md", monkeypatch, "gross", "flights", "--seed", "7")
    assert text.index("## A sensor that fails in service") < text.index("## A gross reading")
    assert "hung for some rows. Target: all of them." in text
    assert text.count("| 300 | 7 |") == 2


def test_what_was_written_by_hand_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = tmp_path / "seen.md"
    made(page, monkeypatch, "gross", "flights")
    whole = seen.whole_of(page)
    written = whole.read_text("utf-8").replace(f"{seen.BEGIN}\n", f"{seen.BEGIN}\nOne was hidden by another.\n", 1)
    whole.write_text(written, "utf-8")
    text = made(page, monkeypatch, "gross")
    assert text.count("One was hidden by another.") == 1
    assert "| 300 | 1 |" in made(page, monkeypatch, "flights")
    assert page.read_text("utf-8").count("One was hidden by another.") == 1
