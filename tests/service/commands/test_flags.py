"""`imu-health flags` against a running service."""

from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

import httpx
import pytest

from service.flags.records import Concern, Matter
from service.records.flagging.acts import Occasion, raise_flag
from service.units.store import Units
from tests.conftest import StockOf
from tests.databases import Databases
from tests.service.commands.conftest import Run
from tests.service.made_sessions import FAILED, session_id
from tests.serving import serving
from tests.stock import stores

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


@pytest.fixture
def address(sqlite: Databases, stock_of: StockOf) -> Iterator[str]:
    """A running service with one flag."""
    with stock_of(sqlite).holding(*FAILED) as settings, serving(settings) as address:
        yield address


def test_open_flags_are_shown(run: Run, address: str) -> None:
    ran = run("flags", "--format", "table", "--server", address)
    assert ran.code == 0
    assert ran.out.splitlines()[1].split()[:3] == ["1", "BA-017", "raised"]


@pytest.mark.slow
def test_more_open_flags_than_a_page_holds_are_all_shown(run: Run, sqlite: Databases, stock_of: StockOf) -> None:
    with stock_of(sqlite).holding(*FAILED) as settings:
        with stores(settings) as storage, storage.database.writing() as store:
            occasion = Occasion(Units(store).key("BA-017"), None, NOW)
            for number in range(1000):
                raise_flag(store, occasion, Concern(Matter.CAUSE, str(number), 1, "seen"))
        with serving(settings) as address:
            assert len(run("flags", "--json", "--server", address).documents) == 1001
            assert len(run("flags", "--state", "raised", "--json", "--server", address).documents) == 1001


def test_a_flag_is_handled_and_then_no_longer_open(run: Run, address: str) -> None:
    own = ("--by", "K. Ito", "--why", "A3 replaced", "--server", address)
    assert "acknowledged" in run("flags", "acknowledge", 1, *own).out
    assert "resolved" in run("flags", "resolve", 1, *own).out
    assert run("flags", "--format", "table", "--server", address).out == "No flag is open.\n"
    [flag] = run("flags", "--state", "resolved", "--json", "--server", address).documents
    assert [change["who"] for change in flag["changes"]] == ["imu-health", "K. Ito", "K. Ito"]


def test_flags_are_given_to_somebody_and_found_by_the_name(run: Run, address: str) -> None:
    assert run("flags", "--assigned", "M. Sato", "--server", address).out == ""
    given = run("flags", "assign", 1, "--to", "M. Sato", "--by", "K. Ito", "--server", address)
    assert given.out.startswith("Flag 1  BA-017")
    [flag] = run("flags", "--assigned", "M. Sato", "--json", "--server", address).documents
    assert flag["assignee"] == "M. Sato"


def test_notes_and_files_are_put_on_a_session(run: Run, address: str, tmp_path: Path) -> None:
    (tmp_path / "photo.png").write_bytes(b"png")
    session, own = session_id(FAILED[0]), ("--by", "K. Ito", "--server", address)
    assert "note 1 recorded" in run("note", session, "the room was warm", *own).out
    assert "attachment 1  photo.png" in run("attach", tmp_path / "photo.png", "--to", session, *own).out
    found = httpx.get(f"{address}/api/v1/sessions/{session}/attachments").json()["attachments"]
    assert [(one["filename"], one["session"]) for one in found] == [("photo.png", session)]
    assert run("attach", tmp_path / "photo.png", "--to", "nobody", *own).code == 1


def test_what_cannot_be_done_is_said_on_one_line(run: Run, address: str) -> None:
    ran = run("flags", "resolve", 7, "--by", "K. Ito", "--why", "gone", "--server", address)
    assert (ran.code, ran.out, ran.err) == (1, "", "imu-health: There is no flag 7.\n")


def test_services_and_notes_are_recorded(run: Run, address: str) -> None:
    own = ("--by", "K. Ito", "--server", address)
    assert "repair 1 recorded" in run("service", "BA-017", "repair", "--sensor", "A3", "--at", "2026-03-01", *own).out
    assert "note 1 recorded" in run("note", "BA-017", "moved by road", *own).out
    unit = httpx.get(f"{address}/api/v1/units/BA-017").json()
    assert [(s["kind"], s["at"], s["who"]) for s in unit["services"]] == [("repair", "2026-03-01T00:00:00Z", "K. Ito")]
    refused = run("service", "BA-017", "paint", *own)
    assert (refused.code, refused.out, refused.err.count("\n")) == (1, "", 1)
