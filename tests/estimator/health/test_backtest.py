"""The back-test of the documentation runs, and what it says in short holds on histories that it has not shown."""

import re
from pathlib import Path

import pytest

from benchmarks.backtest import knowing
from benchmarks.backtest.__main__ import main
from estimator.health import odds, posterior


@pytest.mark.slow
def test_the_small_back_test_writes_every_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "page.md"
    for room, name in ((posterior, "DRAWS"), (odds, "DRAWS"), (knowing, "DRAWS"), (knowing, "FOLLOWED")):
        monkeypatch.setattr(room, name, getattr(room, name) // 5)
    monkeypatch.setattr("sys.argv", ["backtest", "--small", "--seed", "77", "--out", str(out)])
    main()
    text, whole = out.read_text(encoding="utf-8"), (tmp_path / "page-in-full.md").read_text(encoding="utf-8")
    assert whole.count("\n### ") == 12
    days = re.search(r"from the 4th session, median \| (\d+) \|", text)
    assert days is not None
    assert int(days.group(1)) >= 330
