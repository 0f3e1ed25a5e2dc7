"""The fleet report as a workbook and on paper, as it comes over HTTP."""

import io
from collections.abc import Iterator
from datetime import UTC, datetime

import httpx
import polars as pl
import pytest

from service.app import create_app
from service.papers.fleet.paper import fleet_pdf
from service.papers.fleet.report import fleet_report
from service.papers.fleet.workbook import MOST_HISTORY_ROWS, fleet_xlsx
from service.settings import Settings
from service.storage import Storage
from service.storage.queries import Store
from tests.conftest import SettingsFilled
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.dated import upload_and_date
from tests.service.made_sessions import session_bytes
from tests.service.pages.test_queries import queries
from tests.service.papers.documents import pages_of, text_of
from tests.serving import http_client
from tests.stock import stores

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
FORMULA = '=HYPERLINK("mailto:x","BA-018")'


def three_units(settings: Settings) -> None:
    """One that failed, one that passed, and one whose names a spreadsheet would work out."""
    with stores(settings) as storage:
        for unit, moved in (("BA-017", 200.0), ("BA-020", 0.0)):
            upload_and_date(storage, session_bytes(unit=unit, seed=1), "a.json", NOW)
            upload_and_date(storage, session_bytes(unit=unit, seed=2, month=5, a3_moved=moved), "b.json", NOW)
        upload_and_date(storage, session_bytes(unit=FORMULA, seed=3, unit_type="@SUM(A1)"), "c.json", NOW)


@pytest.fixture
def fleet(settings_filled: SettingsFilled) -> Iterator[httpx.Client]:
    """A service with three units."""
    with http_client(create_app(settings_filled(three_units))) as client:
        yield client


def workbook(client: httpx.Client) -> dict[str, pl.DataFrame]:
    """Every sheet as polars reads it."""
    answer = client.get("/api/v1/fleet/report?format=xlsx")
    assert answer.status_code == 200, answer.text
    found: dict[str, pl.DataFrame] = pl.read_excel(io.BytesIO(answer.content), sheet_id=0)
    return found


def paper(client: httpx.Client) -> bytes:
    """The PDF."""
    answer = client.get("/api/v1/fleet/report?format=pdf")
    assert (answer.status_code, answer.headers["content-type"]) == (200, "application/pdf"), answer.text
    return answer.content


def test_the_workbook_holds_what_the_report_says(fleet: httpx.Client) -> None:
    sheets = workbook(fleet)
    units = fleet.get("/api/v1/fleet/report").json()["units"]
    table = sheets["Fleet"]
    assert table["Unit"].to_list() == [unit["serial"] for unit in units]
    assert table["Condition"].to_list()[0].startswith("Unfit")
    assert table["Margin to tolerance"][0] == pytest.approx(units[0]["margin"])
    assert list(sheets) == ["Fleet", "Parameters", "Histories", "About"]


def test_dates_and_numbers_are_dates_and_numbers(fleet: httpx.Client) -> None:
    sheets = workbook(fleet)
    assert sheets["Fleet"]["Last session, UTC"].to_list()[0] == datetime(2026, 5, 1, 9)
    assert sheets["Fleet"]["Next calibration due"].dtype.is_temporal()
    a3 = sheets["Parameters"].filter(Unit="BA-017", Sensor="A3", Parameter="bias")
    assert a3["Deviation"].to_list() == [pytest.approx(200.0, abs=8.0)]
    assert (a3["Unit of deviation"][0], a3["Verdict"][0], a3["Tolerance"][0]) == ("µg", "Unfit", pytest.approx(50.0))


def test_every_parameter_and_every_session_is_there(fleet: httpx.Client) -> None:
    sheets = workbook(fleet)
    assert sheets["Parameters"].group_by("Unit").len()["len"].to_list() == [24, 24, 24]
    history = sheets["Histories"].filter(Unit="BA-017", Sensor="A3", Parameter="bias")
    assert history["Verdict"].to_list() == ["Reference set", "Unfit"]


def test_a_formula_stays_text(fleet: httpx.Client) -> None:
    content = fleet.get("/api/v1/fleet/report?format=xlsx").content
    sheets = pl.read_excel(io.BytesIO(content), sheet_id=0)
    last = sheets["Fleet"].filter(pl.col("Unit") == FORMULA)
    assert (len(last), last["Type"][0]) == (1, "@SUM(A1)")
    assert b"<f>" not in content


def test_the_paper_counts_ranks_and_explains(fleet: httpx.Client) -> None:
    pages = pages_of(paper(fleet))
    text = " ".join(pages)
    reason = fleet.get("/api/v1/units/BA-017").json()["summary"]["reason"]
    assert "3 units" in pages[0]
    assert "BA-017" in text[text.index("Units that are not fit") :]
    assert reason in text
    assert "Units that are not fit" in text
    assert f"Page 1 of {len(pages)}" in pages[0]


def test_the_paper_takes_no_name_for_markup(fleet: httpx.Client) -> None:
    assert "HYPERLINK(" in text_of(paper(fleet)).replace("\u200b", "")


def test_an_empty_fleet_has_a_report(client: httpx.Client) -> None:
    assert "0 units" in text_of(paper(client))
    assert len(workbook(client)["Fleet"]) == 0


@pytest.mark.slow
def test_queries_do_not_grow_with_the_fleet(storage: Storage) -> None:
    def both(store: Store) -> None:
        report = fleet_report(store, NOW)
        fleet_xlsx(store, report)
        fleet_pdf(store, report)

    def add(unit: str, moved: float) -> None:
        upload_and_date(storage, session_bytes(unit=unit, seed=1), "a.json", NOW)
        upload_and_date(storage, session_bytes(unit=unit, seed=2, month=5, a3_moved=moved), "b.json", NOW)

    add("BA-000", 200.0)
    few = queries(storage, both)
    for number in range(1, 4):
        add(f"BA-00{number}", 200.0)
    assert queries(storage, both) == few <= 15


def test_histories_share_the_sheet_alike(storage: Storage, monkeypatch: pytest.MonkeyPatch) -> None:
    for month in range(1, 6):
        upload_and_date(storage, session_bytes(seed=month, month=month), "a.json", NOW)
    monkeypatch.setattr("service.papers.fleet.workbook.MOST_HISTORY_ROWS", 24 * 2)
    assert MOST_HISTORY_ROWS > 24 * 5
    with storage.database.reading() as store:
        content = fleet_xlsx(store, fleet_report(store, NOW))
    shown = pl.read_excel(io.BytesIO(content), sheet_name="Histories")
    assert sorted(set(shown["Measured, UTC"].to_list())) == [datetime(2026, 4, 1, 9), datetime(2026, 5, 1, 9)]


def test_a_simulated_unit_among_measured_ones_is_marked_on_paper(fleet: httpx.Client) -> None:
    simulated = session_bytes(unit="SIM-1", seed=4, origin="simulated")
    assert fleet.post("/api/v1/sessions", content=simulated).status_code == 201
    text = text_of(paper(fleet))
    assert text.count("SIMULATED") >= 1
    assert "; 1 of them simulated." in text
