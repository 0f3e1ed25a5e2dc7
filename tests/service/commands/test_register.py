"""`imu-health units` against a running service."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from service.settings import Settings
from tests.databases import Databases
from tests.service.commands.conftest import Run
from tests.serving import serving

AT = ("--by", "K. Ito", "--server")


@pytest.fixture
def address(sqlite: Databases, tmp_path: Path) -> Iterator[str]:
    """A running service on an empty database."""
    with serving(Settings(database_url=sqlite.migrated(), data_folder=tmp_path / "data")) as address:
        yield address


def test_units_are_imported_moved_retired_and_exported(run: Run, address: str, tmp_path: Path) -> None:
    table, out = tmp_path / "register.csv", tmp_path / "out.csv"
    table.write_text("serial,unit_type,location\nBA-900,RA-9,Hangar 2\nBA-901,RA-9,\n")
    assert run("units", "import", table, *AT, address).out == "2 new, 0 changed, 0 unchanged\n"
    assert "Hangar 3" in run("units", "move", "BA-900", "--location", "Hangar 3", *AT, address).out
    assert "retired" in run("units", "retire", "BA-901", "--why", "lost", *AT, address).out
    shown = run("units", "show", "BA-900", "--server", address).out
    assert "imported from register.csv" in shown
    assert "moved  Hangar 3" in shown
    assert "BA-901" in run("units", "--server", address).out
    assert run("units", "return", "BA-900", "--why", "found", *AT, address).code == 1
    assert run("units", "enter", "BA-902", "--type", "RA-9", *AT, address).code == 0
    assert run("units", "export", "--out", out, "--server", address).code == 0
    assert "BA-900,RA-9" in out.read_text()


def test_a_wrong_table_is_unusable_input(run: Run, address: str, tmp_path: Path) -> None:
    table = tmp_path / "register.csv"
    table.write_text("serial,unit_type\nBA-900,\n")
    ran = run("units", "import", table, *AT, address)
    assert (ran.code, "unit_type, row 1" in ran.err) == (2, True)
