"""The example dashboards: every query of theirs is asked of a real service, and of PostgreSQL as the role that may read
nothing but the views."""

import json
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

import httpx
import psycopg
import pytest
from sqlalchemy import make_url

from tests.conftest import SettingsHolding
from tests.databases import PostgresDatabases
from tests.service.made_sessions import FAILED
from tests.serving import serving

DOCS = Path(__file__).parents[3] / "docs"
PAGE = (DOCS / "how-to" / "dashboards.md").read_text("utf-8")
FROM, TO = 1_735_689_600_000, 1_830_297_600_000
"""2025 to 2027, in milliseconds."""
SHOWN = f"to_timestamp({FROM // 1000}) AND to_timestamp({TO // 1000})"
TYPES = {"string": str, "number": int | float, "timestamp_epoch": int, "timestamp": str, "boolean": bool}
"""Python types of Infinity's columns, as JSON brings them."""
FORMATS: dict[str | None, Callable[[str], str]] = {
    None: str,
    "percentencode": lambda value: quote(value, safe=""),
    "sqlstring": lambda value: "'" + value.replace("'", "''") + "'",
}
"""Formats of Grafana's variables."""
on_postgresql = pytest.mark.parametrize("databases", ["postgresql"], indirect=True)
Query = dict[str, Any]


def dashboard(name: str) -> dict[str, Any]:
    """An example, as Grafana would import it."""
    found: dict[str, Any] = json.loads((DOCS / "dashboards" / f"grafana-{name}.json").read_text("utf-8"))
    return found


def filled(text: str, known: dict[str, str]) -> str:
    """A query as Grafana sends it: every variable and macro in place."""
    text = re.sub(
        r"\$__timeFilter\((\w+)\)", rf"\1 BETWEEN to_timestamp({FROM // 1000}) AND to_timestamp({TO // 1000})", text
    )
    text = re.sub(r"\$\{(\w+)(?::(\w+))?\}", lambda found: FORMATS[found[2]](known[found[1]]), text)
    assert "$" not in text
    return text


def chosen(name: str, ask: Any) -> dict[str, str]:
    """The first value that each of the dashboard's own variables offers, one after another."""
    known = {"__from": str(FROM), "__to": str(TO)}
    for variable in dashboard(name)["templating"]["list"]:
        if variable["type"] == "query":
            known[variable["name"]] = str(next(iter(ask(variable["query"], known)[0].values())))
        elif variable["type"] == "custom":
            known[variable["name"]] = variable["query"].split(",")[0]
    return known


def over_http(address: str, query: Query, known: dict[str, str]) -> list[dict[str, Any]]:
    """The rows that Infinity makes of an answer: selected, named, each column of its type."""
    query = query.get("infinityQuery", query)
    params = {one["key"]: filled(one["value"], known) for one in query["url_options"]["params"]}
    found = httpx.get(address + filled(query["url"], known), params=params).raise_for_status().json()
    rows = found[query["root_selector"]]
    for row in rows:
        for column in query["columns"]:
            value = row[column["selector"]]
            assert value is None or isinstance(value, TYPES[column["type"]]), column
    return [{column["text"]: row[column["selector"]] for column in query["columns"]} for row in rows]


def transformed(panel: dict[str, Any]) -> set[str]:
    """Fields that a panel's transformations ask for."""
    return {field for one in panel["transformations"] for field in one["options"]["fields"]}


def test_every_query_of_the_infinity_dashboard_is_answered(settings_holding: SettingsHolding) -> None:
    with serving(settings_holding(*FAILED)) as address:
        known = chosen("infinity", lambda query, so_far: over_http(address, query, so_far))
        assert (known["unit"], known["sensor"], known["parameter"]) == ("BA-017", "A1", "bias")
        for panel in dashboard("infinity")["panels"]:
            rows = over_http(address, panel["targets"][0], known)
            assert rows, panel["title"]
            assert transformed(panel) <= set(rows[0])


@pytest.fixture
def role(settings_holding: SettingsHolding, postgresql: PostgresDatabases) -> Iterator[str]:
    """The address of a filled database for the role that the page makes."""
    (statements,) = re.findall(r"^```sql\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
    url = settings_holding(*FAILED).database
    with psycopg.connect(url, autocommit=True) as connection:
        connection.execute(statements)
        yield make_url(url).set(username="dashboards", password="choose-one").render_as_string(hide_password=False)
        connection.execute("DROP OWNED BY dashboards; DROP ROLE dashboards")


@on_postgresql
def test_every_query_of_the_postgresql_dashboard_is_answered_to_the_role_of_the_page(role: str) -> None:
    with psycopg.connect(role, row_factory=psycopg.rows.dict_row) as connection:

        def ask(query: str, known: dict[str, str]) -> list[dict[str, Any]]:
            return connection.execute(filled(query, known)).fetchall()

        known = chosen("postgresql", ask)
        for panel in dashboard("postgresql")["panels"]:
            assert ask(panel["targets"][0]["rawSql"], known), panel["title"]


@on_postgresql
@pytest.mark.parametrize("statement", ["SELECT * FROM sessions", "DELETE FROM flags", "CREATE TABLE x (y int)"])
def test_that_role_can_do_nothing_else(role: str, statement: str) -> None:
    with psycopg.connect(role) as connection, pytest.raises(psycopg.errors.InsufficientPrivilege):
        connection.execute(statement)


@pytest.mark.parametrize("databases", ["sqlite"], indirect=True)
def test_the_notebook_s_lines_of_the_page_run(settings_holding: SettingsHolding) -> None:
    (lines,) = re.findall(r"^```python\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
    with serving(settings_holding(*FAILED)) as address:
        own = lines.replace("http://127.0.0.1:8000", address).replace("BA-900", "BA-017")
        done = subprocess.run([sys.executable, "-c", own], capture_output=True, text=True, check=True)
    assert "undecidable" in done.stdout
    assert "fail" in done.stdout
