"""`imu-health upload`, `fleet` and `report` against a running service."""

import json
from collections.abc import Iterator
from pathlib import Path

import httpx
import polars as pl
import pytest

from service.settings import Settings
from tests.builders import accelerometer_block, raw_log
from tests.databases import Databases
from tests.service import tables
from tests.service.commands.conftest import Run, write
from tests.service.filled import filled
from tests.service.made_sessions import session_id
from tests.serving import serving


@pytest.fixture
def address(sqlite: Databases, tmp_path: Path) -> Iterator[str]:
    """A running service on an empty database."""
    with serving(Settings(database_url=sqlite.migrated(), data_folder=tmp_path / "data")) as address:
        yield address


@pytest.fixture
def two_sessions(tmp_path: Path) -> list[Path]:
    """A unit's reference session, and one in which nothing has changed."""
    first, later = (accelerometer_block(positions=36, seed=seed) for seed in (1, 9))
    later["started_at"] = "2026-05-01T09:00:00Z"
    return [write(tmp_path, "first.json", first), write(tmp_path, "later.json", later)]


def test_an_uploaded_file_is_in_the_service(run: Run, address: str, good_file: Path) -> None:
    ran = run("upload", good_file, "--server", address, "--json")
    [receipt] = ran.documents
    assert (ran.code, receipt["unit"], receipt["created"]) == (0, "BA-017", True)
    assert httpx.get(f"{address}/api/v1/sessions/{receipt['id']}/file").content == good_file.read_bytes()


def test_the_same_file_twice_is_stored_once(run: Run, address: str, good_file: Path) -> None:
    first, again = run("upload", good_file, good_file, "--server", address, "--json").documents
    assert first["id"] == again["id"]
    assert (first["created"], again["created"]) == (True, False)


def test_a_refused_file_names_field_and_row_and_stops_no_other(
    run: Run, address: str, bad_file: Path, good_file: Path
) -> None:
    ran = run("upload", bad_file, good_file, "--server", address, "--json")
    assert (ran.code, len(ran.documents), ran.err.count("\n")) == (2, 1, 1)
    for part in (str(bad_file), "A2, row 3", "stand.alpha_deg", "A4_se, row 5"):
        assert part in ran.err


def test_a_batch_ends_with_a_line_that_counts_the_failed_first(
    run: Run, address: str, bad_file: Path, good_file: Path
) -> None:
    ran = run("upload", good_file, good_file, bad_file, "--server", address)
    assert (ran.code, "already stored as session" in ran.out) == (2, True)
    assert ran.err.splitlines()[-1] == f"1 of 3 files failed: {bad_file}; 1 stored, 1 stored before."


def test_a_missing_file_is_unusable_input(run: Run, address: str, tmp_path: Path) -> None:
    ran = run("upload", tmp_path / "missing.json", "--server", address)
    assert ran.code == 2
    assert "missing.json" in ran.err


def test_the_verdict_is_printed_in_words(run: Run, address: str, two_sessions: list[Path]) -> None:
    ran = run("upload", *two_sessions, "--server", address)
    assert ran.code == 0
    units, sessions, verdicts, _ = zip(*(line.split("  ") for line in ran.out.splitlines()), strict=True)
    assert (units, verdicts) == (("BA-017", "BA-017"), ("Reference set", "Fit"))
    assert sessions == tuple(session_id(file.read_bytes()) for file in two_sessions)


@pytest.mark.parametrize("server", ["http://127.0.0.1:1", "nonsense", "http://[", "http://127.0.0.1:1/" + "a" * 70_000])
def test_a_server_that_does_not_answer_is_said_on_one_line(run: Run, good_file: Path, server: str) -> None:
    ran = run("upload", good_file, "--server", server)
    assert (ran.code, ran.out, ran.err.count("\n")) == (1, "", 1)


def test_the_fleet_is_shown_worst_first(run: Run, address: str, two_sessions: list[Path], tmp_path: Path) -> None:
    other = write(tmp_path, "other.json", accelerometer_block(unit="BA-100"))
    run("upload", *two_sessions, other, "--server", address)
    lines = run("fleet", "--table", "--server", address).out.splitlines()
    assert lines[0] == "2 units: 1 Fit, 1 Reference set"
    assert [line.split()[0] for line in lines if line.startswith("BA-")] == ["BA-100", "BA-017"]


def test_a_pipe_gets_one_unit_a_line_and_who_chooses_a_list(run: Run, address: str, good_file: Path) -> None:
    run("upload", good_file, "--server", address)
    [unit] = run("fleet", "--server", address).documents
    assert (unit["serial"], unit["verdict"]) == ("BA-017", "undecidable")
    assert run("fleet", "--server", address, "--json").documents == [unit]


def test_some_of_the_fleet_are_shown(run: Run, address: str, two_sessions: list[Path], tmp_path: Path) -> None:
    document = accelerometer_block(unit="BA-100")
    document["stand"]["id"] = "S9"
    run("upload", *two_sessions, write(tmp_path, "other.json", document), "--server", address)
    assert [unit["serial"] for unit in run("fleet", "--stand", "S9", "--server", address).documents] == ["BA-100"]
    shown = run("fleet", "--stand", "S9", "--table", "--server", address).out
    assert shown.startswith("1 of 2 units")


def test_noise_at_rest_is_shown_with_its_interval_and_no_verdict(run: Run, address: str, tmp_path: Path) -> None:
    ran = run("upload", write(tmp_path, "log.json", raw_log(still=300)), "--server", address, "--json")
    httpx.get(f"{address}/api/v1/sessions/{ran.documents[0]['id']}/diagnosis")
    shown = run("history", "LOG-1", "--parameter", "white-noise", "--table", "--server", address).out
    lines = [line for line in shown.splitlines() if "white-noise" in line]
    assert lines
    assert all(" to " in line and "Undecided" not in line and "Reference" not in line for line in lines)


def test_a_history_is_shown_beside_its_reference(run: Run, address: str, two_sessions: list[Path]) -> None:
    run("upload", *two_sessions, "--server", address)
    asked = ("history", "BA-017", "--sensor", "A3", "--parameter", "bias", "--server", address)
    assert [point["is_reference"] for point in run(*asked).documents] == [True, False]
    heading, first, later = run(*asked, "--table").out.splitlines()
    assert heading.split()[:3] == ["measured", "sensor", "parameter"]
    assert (first.split()[:3], later.split()[:3]) == (["2026-03-01", "A3", "bias"], ["2026-05-01", "A3", "bias"])
    assert "±" in later


def test_the_report_is_a_table_for_other_programs(run: Run, address: str, good_file: Path, tmp_path: Path) -> None:
    run("upload", good_file, "--server", address)
    target = tmp_path / "fleet.csv"
    assert run("report", "--server", address, "--out", target).code == 0
    assert pl.read_csv(target)["serial"].to_list() == ["BA-017"]
    [report] = run("report", "--server", address, "--format", "json").documents
    assert report["units"][0]["serial"] == "BA-017"


@pytest.mark.parametrize(("format", "head"), [("xlsx", b"PK"), ("pdf", b"%PDF")])
def test_the_report_is_written_as_workbook_and_on_paper(
    run: Run, address: str, good_file: Path, tmp_path: Path, format: str, head: bytes
) -> None:
    run("upload", good_file, "--server", address)
    target = tmp_path / f"fleet.{format}"
    assert run("report", "--server", address, "--format", format, "--out", target).code == 0
    assert target.read_bytes().startswith(head)


def test_parameters_of_a_flight_controller_are_written(run: Run, address: str, good_file: Path, tmp_path: Path) -> None:
    [receipt] = run("upload", good_file, "--server", address, "--json").documents
    target = tmp_path / "unit.params"
    assert run("export", receipt["id"], "--system", "px4", "--force", "--server", address, "--out", target).code == 0
    assert "CAL_ACC0_XOFF" in target.read_text("utf-8")
    ran = run("export", "../none", "--system", "px4", "--server", address)
    assert (ran.code, ran.out, ran.err.count("\n")) == (1, "", 1)


def test_a_template_filled_in_is_taken(run: Run, address: str, tmp_path: Path) -> None:
    empty, full = tmp_path / "empty.xlsx", tmp_path / "full.xlsx"
    assert run("template", "--sensors", 4, "--out", empty, "--server", address).code == 0
    full.write_bytes(filled(empty.read_bytes(), {"unit": "MY-1", "stand.id": "S1"}))
    [receipt] = run("upload", full, "--server", address, "--json").documents
    assert receipt["unit"] == "MY-1"


def test_a_table_of_ones_own_is_uploaded_with_its_mapping(run: Run, address: str, tmp_path: Path) -> None:
    own, mapping = tmp_path / "own.csv", tmp_path / "mapping.json"
    own.write_bytes(tables.text_table(tables.own_document()).encode("cp1251"))
    sent = {"file": (own.name, own.read_bytes())}
    found = httpx.post(f"{address}/api/v1/layouts/preview", files=sent).json()["mapping"]
    mapping.write_text(json.dumps({**found, "session": tables.facts_of(tables.own_document())}), encoding="utf-8")
    [receipt] = run("upload", own, "--mapping", mapping, "--server", address, "--json").documents
    assert receipt["unit"] == "BA-017"
