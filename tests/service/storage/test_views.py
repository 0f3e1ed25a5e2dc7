"""The views that dashboards read: what the API says, under the names that the documentation gives."""

import re
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import inspect, text

from service.app import create_app
from service.settings import Settings
from service.storage.engine import open_engine
from service.storage.schema import downgrade, upgrade
from tests.conftest import SettingsHolding
from tests.service.made_sessions import FAILED, session_bytes
from tests.serving import http_client

PAGE = Path(__file__).parents[3] / "docs" / "how-to" / "dashboards.md"
MOMENTS = ("at", "last_at", "due", "raised_at")
Rows = Sequence[dict[str, Any]]


@pytest.fixture
def measured(settings_holding: SettingsHolding) -> Settings:
    """A unit out of tolerance, and another one with a reference only."""
    return settings_holding(*FAILED, session_bytes(unit="BA-018"))


def rows(url: str, query: str) -> Rows:
    """Rows that a view shows to whoever is connected to the database."""
    engine = open_engine(url)
    with engine.connect() as connection:
        found = [dict(row._mapping) for row in connection.execute(text(query))]
    engine.dispose()
    return found


def shared(seen: Rows, told: Rows) -> tuple[list[list[Any]], list[list[Any]]]:
    """The columns that both have, moments alike."""
    names = sorted(set(seen[0]) & set(told[0]) - {"reservations", "diagnosis"})
    assert len(names) > 5
    return tuple([[plain(row[name], name) for name in names] for row in found] for found in (seen, told))  # type: ignore[return-value]


def plain(value: Any, name: str) -> Any:
    """A moment of either engine, or of JSON, as one."""
    if name not in MOMENTS or value is None:
        return value
    moment = datetime.fromisoformat(value) if isinstance(value, str) else value
    return moment.replace(tzinfo=UTC) if moment.tzinfo is None else moment.astimezone(UTC)


def read(settings: Settings, path: str) -> Any:
    """Answer of the API."""
    with http_client(create_app(settings)) as client:
        return client.get(f"/api/v1/{path}").json()


def test_the_history_is_that_of_the_api(measured: Settings) -> None:
    seen = rows(
        measured.database,
        "SELECT * FROM health_history WHERE unit = 'BA-017' ORDER BY at, session, sensor, parameter",
    )
    told = read(measured, "units/BA-017/history")["points"]
    assert len(told) == 48
    mine, theirs = shared(seen, told)
    assert mine == theirs


def test_the_units_are_those_of_the_fleet_report(measured: Settings) -> None:
    seen = rows(measured.database, "SELECT * FROM health_units ORDER BY severity DESC, margin")
    told = read(measured, "fleet/report")["units"]
    assert [row["unit"] for row in seen] == [unit["serial"] for unit in told] == ["BA-017", "BA-018"]
    mine, theirs = shared(seen, told)
    assert mine == theirs


def test_the_margin_of_a_unit_is_that_of_its_worst_parameter(measured: Settings) -> None:
    (unit,) = rows(measured.database, "SELECT * FROM health_units WHERE unit = 'BA-017'")
    worst = "SELECT MIN(margin) AS margin FROM health_history WHERE session = '{last_session}'".format(**unit)
    assert rows(measured.database, worst)[0]["margin"] == pytest.approx(unit["margin"], rel=1e-9)


def test_sessions_and_flags_are_those_of_the_api(measured: Settings) -> None:
    seen = rows(
        measured.database, "SELECT session AS id, verdict, state, unit FROM health_sessions ORDER BY at DESC, id DESC"
    )
    told = read(measured, "sessions")["sessions"]
    assert [(row["id"], row["verdict"], row["unit"]) for row in seen] == [
        (session["id"], session["verdict"], session["unit"]) for session in told
    ]  # fmt: skip
    flags = rows(measured.database, "SELECT id, unit, matter, place, state FROM health_flags ORDER BY id")
    assert flags == [
        {name: flag[name] for name in ("id", "unit", "matter", "place", "state")}
        for flag in read(measured, "flags")["flags"]
    ]
    assert flags


def test_a_withdrawn_session_is_no_point_of_a_history_but_a_session_still(measured: Settings) -> None:
    with http_client(create_app(measured)) as client:
        last = client.get("/api/v1/units/BA-017").json()["summary"]["last_session"]
        client.post(f"/api/v1/sessions/{last}/withdraw", json={"by": "K. Ito", "why": "slipped"}).raise_for_status()
    assert rows(measured.database, f"SELECT 1 FROM health_history WHERE session = '{last}'") == []
    (session,) = rows(measured.database, f"SELECT state FROM health_sessions WHERE session = '{last}'")
    assert session == {"state": "withdrawn"}


def test_a_unit_without_an_accepted_session_is_shown_without_a_verdict(measured: Settings) -> None:
    with http_client(create_app(measured)) as client:
        last = client.get("/api/v1/units/BA-018").json()["summary"]["last_session"]
        client.post(f"/api/v1/sessions/{last}/withdraw", json={"by": "K. Ito", "why": "slipped"}).raise_for_status()
    (unit,) = rows(measured.database, "SELECT sessions, verdict FROM health_units WHERE unit = 'BA-018'")
    assert unit == {"sessions": 0, "verdict": None}


def test_a_retired_unit_can_be_left_out(measured: Settings) -> None:
    with http_client(create_app(measured)) as client:
        client.put("/api/v1/units/BA-017/register", json={"location": "Hangar 2", "by": "K. Ito"}).raise_for_status()
        client.post("/api/v1/units/BA-017/retire", json={"by": "K. Ito", "why": "scrapped"}).raise_for_status()
    found = rows(measured.database, "SELECT unit, location, retired_at IS NULL AS used FROM health_units ORDER BY unit")
    assert [(row["unit"], row["location"], bool(row["used"])) for row in found] == [
        ("BA-017", "Hangar 2", False), ("BA-018", "", True),
    ]  # fmt: skip
    assert all(row["is_of_retired"] for row in rows(measured.database, "SELECT * FROM health_flags"))


def documented() -> dict[str, list[str]]:
    """Views and their columns, as the page lists them."""
    sections = re.split(r"^### `(health_\w+)`", PAGE.read_text("utf-8"), flags=re.MULTILINE)[1:]
    names, bodies = sections[::2], sections[1::2]
    listed = (re.findall(r"^\| (`.*?) \|", body, re.MULTILINE) for body in bodies)
    return {
        n: [c for cell in cells for c in re.findall(r"`(\w+)`", cell)] for n, cells in zip(names, listed, strict=True)
    }


def test_every_view_has_the_columns_that_are_documented(store_url: str) -> None:
    engine = open_engine(store_url)
    found = inspect(engine)
    assert {name: [c["name"] for c in found.get_columns(name)] for name in found.get_view_names()} == documented()
    engine.dispose()


def test_the_views_go_with_their_migration_and_come_again_with_it(measured: Settings) -> None:
    before = rows(measured.database, "SELECT * FROM health_history ORDER BY session, sensor, parameter")
    downgrade(measured.database, "0017")
    engine = open_engine(measured.database)
    assert inspect(engine).get_view_names() == []
    engine.dispose()
    upgrade(measured.database)
    assert rows(measured.database, "SELECT * FROM health_history ORDER BY session, sensor, parameter") == before
