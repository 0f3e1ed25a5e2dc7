"""`imu-health parity` on files as people have them."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from benchmarks.files.hostile import HOSTILE, Hostile
from estimator.errors import FormatError
from estimator.session import CalibrationSession
from service.ingest.jobs import HEAD, recording
from service.ingest.stream import open_recording
from service.kit import limits
from tests.service.commands.conftest import Run
from tests.service.faulty_recordings import faulty_bytes
from tests.service.made_sessions import session_bytes
from tests.service.recordings import recording_bytes, recording_document

HARMFUL = ("parquet-long-texts", "csv-many-columns", "csv-row-of-a-million", "xlsx-cells-without-r")
"""One of each way in which a recording is read, and one that is read whole."""


@pytest.fixture
def reference(tmp_path: Path) -> Path:
    path = tmp_path / "reference.json"
    path.write_bytes(session_bytes())
    return path


def columnar(path: Path, **changes) -> Path:
    """The recording as Parquet or CSV."""
    document = recording_document(**changes)
    frame = pl.DataFrame(document.pop("table"))
    if path.suffix == ".parquet":
        frame.write_parquet(path, metadata={"imu-session": json.dumps(document)})
    else:
        head = "\n".join(f"# {line}" for line in json.dumps(document, indent=1).splitlines())
        path.write_text(f"{head}\n{frame.write_csv()}", encoding="utf-8")
    return path


def test_a_drift_is_told_in_a_sentence(run: Run, tmp_path: Path, reference: Path) -> None:
    flight = tmp_path / "flight.json"
    flight.write_bytes(recording_bytes(a3_moved=400.0))
    done = run("parity", flight, "--reference", reference)
    assert "A3 has changed since the calibration: bias +4" in done.out


def test_a_sensor_that_begins_to_fail_is_told_with_its_second_and_what_to_do(
    run: Run, tmp_path: Path, reference: Path
) -> None:
    flight = tmp_path / "flight.json"
    flight.write_bytes(faulty_bytes("stuck"))
    done, document = (
        run("parity", flight, "--reference", reference),
        run("parity", flight, "--reference", reference, "--json"),
    )
    said = " ".join(done.out.split())
    assert "A3 has stood still since 09:02:00 UTC (120 s into the recording): replace or repair A3, and check" in said
    assert "Before that: no change since the calibration. From then on, without A3: nothing else has" in said
    assert (done.code, json.loads(document.out)["faults"][0]["kind"]) == (0, "stuck")


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_every_format_gives_the_same_result(run: Run, tmp_path: Path, reference: Path, suffix: str) -> None:
    flight = tmp_path / "flight.json"
    flight.write_bytes(recording_bytes())
    scanned = columnar(tmp_path / f"flight.{suffix}")
    whole, streamed = (json.loads(run("parity", f, "--reference", reference, "--json").out) for f in (flight, scanned))
    assert streamed["chi2"] == pytest.approx(whole["chi2"], rel=1e-9)
    assert streamed["format"] == "imu-parity/1"


def test_a_file_comes_in_chunks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.ingest.long_log.CHUNK_BYTES", 50_000)
    head, *chunks = recording(columnar(tmp_path / "flight.csv"), "flight.csv")
    assert isinstance(head, CalibrationSession)
    assert len(np.vstack(chunks)) == 2400
    assert len(chunks) > 1
    assert (head.unit, len(head.readings)) == ("BA-017", HEAD)


def test_a_recording_is_read_by_a_process_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = columnar(tmp_path / "flight.csv")
    monkeypatch.delattr(pl, "scan_csv")  # this process can read none from now on
    assert sum(len(chunk) for chunk in open_recording(path).chunks) == 2400


def test_a_recording_of_more_cells_than_allowed_is_refused(tmp_path: Path) -> None:
    usual = limits.in_force()
    limits.use(replace(usual, log_cells=12_000))
    opened = open_recording(columnar(tmp_path / "flight.parquet"))
    limits.use(usual)
    with pytest.raises(FormatError, match="more than 12000 cells"):
        list(opened.chunks)


@pytest.mark.parametrize("hostile", [one for one in HOSTILE if one.name in HARMFUL], ids=lambda one: one.name)
def test_a_hostile_recording_is_unusable_input(run: Run, tmp_path: Path, reference: Path, hostile: Hostile) -> None:
    file = tmp_path / "flight"
    file.write_bytes(hostile.make())
    done = run("parity", file, "--reference", reference)
    assert (done.code, done.err.count("\n")) == (2, 1)


def test_a_row_with_a_missing_value_says_nothing(run: Run, tmp_path: Path, reference: Path) -> None:
    path = columnar(tmp_path / "flight.csv")
    lines = path.read_text(encoding="utf-8").splitlines()
    lines[-100] = "," + lines[-100].partition(",")[2]
    path.write_text("\n".join(lines), encoding="utf-8")
    done = run("parity", path, "--reference", reference)
    assert (done.code, done.err) == (0, "")


def test_text_among_numbers_is_unusable(run: Run, tmp_path: Path, reference: Path) -> None:
    path = columnar(tmp_path / "flight.csv")
    path.write_text(path.read_text(encoding="utf-8") + "a,b,c,d,e,f\n", encoding="utf-8")
    done = run("parity", path, "--reference", reference)
    assert (done.code, "cannot be read to its end" in done.err) == (2, True)


def test_a_missing_reference_is_named(run: Run, tmp_path: Path) -> None:
    flight = tmp_path / "flight.json"
    flight.write_bytes(recording_bytes())
    done = run("parity", flight, "--reference", tmp_path / "none.json")
    assert (done.code, "none.json: file: No such file" in done.err) == (2, True)


def test_the_readings_are_those_of_the_file(tmp_path: Path) -> None:
    document = recording_document()
    chunks = np.vstack(list(open_recording(columnar(tmp_path / "flight.parquet")).chunks))
    assert np.array_equal(chunks, np.column_stack([document["table"][f"A{k}"] for k in range(1, 7)]))
