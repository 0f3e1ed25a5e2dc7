"""`imu-health diagnose` and `recalibrate`: what they print, and their exit codes."""

import json
from pathlib import Path

import pytest

from service.settings import Settings
from service.uploads.receive import upload
from tests.databases import Databases
from tests.service.commands.conftest import Run, write
from tests.service.diagnosed import ALIASES, DOUBTED, TEMPERATURE, UNEXPLAINED, boasting, drawn, swaying_stand, warm
from tests.service.recordings import recording_document
from tests.service.records.test_diagnose import NOW
from tests.stock import stores


@pytest.fixture
def warm_file(tmp_path: Path) -> Path:
    """A session in which A5 follows the temperature."""
    return write(tmp_path, "warm.json", drawn(TEMPERATURE).session)


WARM = drawn(TEMPERATURE).session


def test_one_file_with_json_gives_the_object(run: Run, warm_file: Path) -> None:
    ran = run("diagnose", warm_file, "--json")
    (document,) = ran.documents
    assert (ran.code, document["format"]) == (0, "imu-diagnosis/1")
    assert [(f["cause"], f["sensors"]) for f in document["findings"]] == [("bias-temperature", ["A5"])]


def test_people_read_the_cause_its_size_and_what_to_do(run: Run, warm_file: Path) -> None:
    shown = run("diagnose", warm_file).out
    for part in ("The bias of A5 depends on temperature.", "What to do:", "±", "µg/K", "Not detectable"):
        assert part in shown


def test_a_programme_in_which_no_causes_are_looked_for_is_no_fault(run: Run, tmp_path: Path) -> None:
    file = write(tmp_path, "flight.json", recording_document())
    shown = run("diagnose", file)
    assert (shown.code, "Not applicable to this programme" in shown.out) == (0, True)
    (document,) = run("diagnose", file, "--json").documents
    assert (document["findings"], document["unexplained"], document["gain"]) == ([], False, None)


def test_a_choice_is_shown_with_what_would_decide_it(run: Run, tmp_path: Path) -> None:
    shown = run("diagnose", write(tmp_path, "a.json", drawn(ALIASES).session)).out
    assert "less likely odd quadratic" in shown
    assert "separat" in shown


def test_structure_without_a_name_is_shown_where_it_lives(run: Run, tmp_path: Path) -> None:
    assert "harmonic 5" in run("diagnose", write(tmp_path, "a.json", drawn(UNEXPLAINED).session)).out


def test_wrong_standard_errors_are_said(run: Run, tmp_path: Path) -> None:
    shown = run("diagnose", write(tmp_path, "a.json", boasting())).out
    assert "Nothing wrong found, but the stated standard errors are about 4 times too small." in shown


def test_what_all_sensors_show_sends_people_to_the_stand(run: Run, tmp_path: Path) -> None:
    shown = run("diagnose", write(tmp_path, "a.json", swaying_stand())).out
    assert "An effect common to all sensors, of the stand or fixture" in shown
    assert "What to do: All sensors show it" in shown


def test_a_name_beside_an_unknown_cause_keeps_its_advice(run: Run, tmp_path: Path) -> None:
    shown = run("diagnose", write(tmp_path, "a.json", drawn(DOUBTED).session)).out
    assert "The bias of A2 has one step (95.1\xa0% likely), or a cause outside the catalogue." in shown
    assert "If it appears again: " in shown


def test_a_history_that_cannot_be_read_is_unusable_input(run: Run, warm_file: Path, bad_file: Path) -> None:
    ran = run("diagnose", warm_file, "--history", bad_file, "--json")
    assert (ran.code, ran.out) == (2, "")
    assert str(bad_file) in ran.err


def test_recalibrate_works_on_the_database(run: Run, sqlite: Databases, tmp_path: Path) -> None:
    settings = Settings(database_url=sqlite.migrated(), data_folder=tmp_path)
    with stores(settings) as storage:
        upload(storage, json.dumps(WARM).encode(), "a.json", NOW)
    unit, where = WARM["unit"], ("--database-url", settings.database, "--data-folder", tmp_path)
    ran = run("recalibrate", unit, *where, "--json")
    assert [(d["sessions"], d["recomputed"], d["unchanged"]) for d in ran.documents] == [(1, 0, 1)]
    assert run("recalibrate", "--all", *where).out.startswith("Nothing to do")
    assert run("recalibrate", *where).out.startswith("Nothing to do")
    assert run("recalibrate", "none", *where).code == 1


def test_what_is_recalibrated_is_said_in_one_way(run: Run) -> None:
    ran = run("recalibrate", "BA-017", "--all")
    assert (ran.code, ran.err) == (
        1,
        "Invalid value: give serial numbers of units, or --all, which is what none means\n",
    )


def test_people_read_how_the_size_fits_the_session_before(run: Run, tmp_path: Path) -> None:
    before = write(tmp_path, "before.json", warm(1, "2026-01-05T08:00:00Z"))
    shown = run("diagnose", write(tmp_path, "now.json", warm(2, "2026-03-05T08:00:00Z")), "--history", before).out
    assert "Predicting positions held out of the estimation" in shown
    assert "Predicting the session before (2026-01-05" in shown
