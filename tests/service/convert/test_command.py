"""`python -m benchmarks.convert`: files of a public recording become session files."""

import sys
from pathlib import Path

import pytest

from benchmarks.convert.__main__ import main
from estimator.reading import read_session
from tests.service.convert import made


def test_a_recording_becomes_session_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    files = [str(path) for path in made.ferraris_csv(tmp_path)]
    monkeypatch.setattr(sys, "argv", ["convert", "ferraris-csv", *files, "--out", str(tmp_path / "sessions")])
    assert main() == 0
    [file] = capsys.readouterr().out.splitlines()
    assert Path(file).parent == tmp_path / "sessions"
    assert read_session(Path(file)).block == "accelerometer"


def test_a_damaged_recording_is_unusable_input(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    broken = tmp_path / "annotated.csv"
    broken.write_text("part,samples\nx_p,1\n", encoding="utf-8")
    monkeypatch.setattr(sys, "argv", ["convert", "ferraris-csv", str(broken), "--out", str(tmp_path / "none")])
    assert main() == 2
    assert "annotated.csv" in capsys.readouterr().err
    assert not (tmp_path / "none").exists()
