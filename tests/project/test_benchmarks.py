"""The table of the benchmarks: what is measured anew takes its place, and what fails loses nothing."""

import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.__main__ import RESULTS
from benchmarks.figures import Felt, Figure
from benchmarks.results import BENCHMARKS, Results, benchmark_of, id_of, note_of


def row(id: str, ours: float) -> str:
    return Figure(id, "work", "peer", ours, 1.0, "≥ 0.5").row()


def test_a_row_that_is_measured_anew_takes_its_place(tmp_path: Path) -> None:
    first = Results(tmp_path / "R.md")
    for line in (row("P2, solves", 1.0), row("P11", 1.0), row("P1", 1.0)):
        first.put(line)
    again = Results.read(tmp_path / "R.md")
    again.put(row("P11", 0.25))
    kept = Results.read(tmp_path / "R.md").rows
    assert list(kept) == ["P1", "P2, solves", "P11"]
    assert "| 250 ms | peer | 1 s | 4 |" in kept["P11"]


@pytest.mark.parametrize(("end", "left"), [("whole", ["P4"]), ("failed", ["P4", "P4h"])])
def test_only_a_benchmark_that_came_to_its_end_takes_out_rows(tmp_path: Path, end: str, left: list[str]) -> None:
    results = Results(tmp_path / "R.md")
    for id in ("P4", "P4h"):
        results.put(row(id, 1.0))
    results.ended("P4", {"P4"}, 3.0, end)
    again = Results.read(tmp_path / "R.md")
    assert (list(again.rows), f"| 3 | {end} |" in again.runs["P4"]) == (left, True)


def test_a_benchmark_that_fails_keeps_the_others_rows(tmp_path: Path) -> None:
    out = tmp_path / "R.md"
    Results(out).put(row("P1", 1.0))
    ours = [sys.executable, "-m", "benchmarks", "--only", "rivals", "--out", str(out)]
    nowhere = {"IMU_HEALTH_RECORDINGS": str(tmp_path / "none"), "PATH": ""}
    assert subprocess.run(ours, env=nowhere, cwd=RESULTS.parents[1], capture_output=True).returncode == 1
    kept = Results.read(out)
    assert list(kept.rows) == ["P1"]
    assert "| failed |" in kept.runs["rivals"]


def test_a_target_is_reached_from_its_ratio_on() -> None:
    def reached(ratio: float, target: str) -> str:
        return Figure("P1", "work", "peer", 1.0, ratio, target).reached

    assert [reached(0.5, "at least 1/2"), reached(0.66, "at least 2/3"), reached(30, "30"), reached(9, "—")] == [
        "yes", "no", "yes", "—",
    ]  # fmt: skip


def test_what_a_user_feels_leads_the_table_with_its_time_in_m(tmp_path: Path) -> None:
    results = Results(tmp_path / "R.md")
    rows = (Felt("U10", "stand", 0.2, 1.0, "s", m=0.1), Felt("U2, 1 client", "upload", 0.05, 0.4, m=0.1))
    for line in (row("P1", 1.0), *(felt.row() for felt in rows), Felt("U7", "at rest", 264.0, 150, "MB", m=0.1).row()):
        results.put(line)
    written = (tmp_path / "R.md").read_text("utf-8")
    assert [id_of(line) for line in written.splitlines() if line.startswith("| ") and benchmark_of(line)] == [
        "U2, 1 client",
        "U7",
        "U10",
        "P1",
    ]
    assert "| U2, 1 client | upload | 50 ms | 0.5 m | ≤ 0.4 m | no |" in written
    assert "| U7 | at rest | 264 MB | — | ≤ 150 MB | no |" in written
    assert "| U10 | stand | 200 ms | 2 m | ≤ 1 s | yes |" in written


def test_every_missed_target_is_explained() -> None:
    missed = {benchmark_of(line) for line in Results.read(RESULTS).rows.values() if line.endswith("| no |")}
    assert missed
    assert [key for key in sorted(missed) if not note_of(key)] == []


def test_every_benchmark_is_a_file_whose_rows_are_known_as_its_own() -> None:
    folder = RESULTS.parent
    assert all((folder / f"{name}.py").exists() for name in BENCHMARKS.values())
    assert {benchmark_of(row(f"{key}, part", 1.0)) for key in BENCHMARKS} == set(BENCHMARKS)
    assert id_of(row("P4h", 1.0)) == "P4h"
