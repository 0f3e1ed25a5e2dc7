"""`imu-health convert`: files of a public recording become session files."""

from pathlib import Path

from estimator.reading import read_session
from tests.service.cli.conftest import Run
from tests.service.convert import made


def test_a_recording_becomes_session_files_that_can_be_calibrated(run: Run, tmp_path: Path) -> None:
    ran = run("convert", "ferraris-csv", *made.ferraris_csv(tmp_path), "--out", tmp_path / "sessions")
    assert ran.code == 0
    [file] = ran.out.splitlines()
    assert Path(file).parent == tmp_path / "sessions"
    assert read_session(Path(file)).block == "accelerometer"
    assert run("calibrate", file).code == 0


def test_a_damaged_recording_is_unusable_input(run: Run, tmp_path: Path) -> None:
    broken = tmp_path / "annotated.csv"
    broken.write_text("part,samples\nx_p,1\n", encoding="utf-8")
    ran = run("convert", "ferraris-csv", broken, "--out", tmp_path / "none")
    assert (ran.code, ran.err.count("\n")) == (2, 1)
    assert "annotated.csv" in ran.err
    assert not (tmp_path / "none").exists()


def test_an_unknown_format_is_refused(run: Run, tmp_path: Path) -> None:
    ran = run("convert", "nonsense", tmp_path / "x")
    assert ran.code == 1
    assert "nonsense" in ran.err
