"""The demonstration fleet: what it shows, that it is always the same, and that it is never mixed with real units."""

from collections import Counter
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from threading import Event

import httpx
import pytest

from estimator.reading import read_session
from service.commands import serve
from service.demo.cast import CAST, END
from service.demo.fill import FILES, fill, is_wanted
from service.demo.history import files_of
from service.flags.store import FlagQuery, Flags
from service.fleet.records import FleetQuery
from service.fleet.store import Fleet
from service.models.records import Scope
from service.outlook.reading import outlook_of
from service.records.flagging.overdue_units import flag_overdue
from service.records.flagging.stands import flag_shifted_stands
from service.sessions.decision import Verdict
from service.sessions.records import SessionQuery
from service.sessions.store import Sessions
from service.settings import Settings
from service.stands.health import stand_health
from service.storage import Storage
from service.storage.schema import upgrade
from service.units.remarks_store import Notes
from service.units.store import Services
from service.uploads.receive import upload
from service.work.watch import update_outlooks
from tests.conftest import StockOf
from tests.databases import Databases
from tests.patience import LONG
from tests.service.commands.conftest import COMMAND, Run, started
from tests.service.commands.said_alike import check_unit, fleet_of
from tests.serving import serving
from tests.stock import stores

CONDITIONS = {
    "BA-103": Verdict.PASS,
    "BA-104": Verdict.CONDITIONAL_PASS,
    "BA-105": Verdict.CONDITIONAL_FAIL,
    "BA-106": Verdict.FAIL,
    "BA-107": Verdict.PASS,
    "BA-108": Verdict.UNDECIDABLE,
    "BA-111": Verdict.FAIL,
    "RT-301": Verdict.CONDITIONAL_PASS,
}

BEGUN = CAST[:3]
"""Units that the first filling of the served demonstration ends with: a flag resolved, a note written."""


@pytest.fixture
def empty(sqlite: Databases, stock_of: StockOf) -> Iterator[Storage]:
    """Stores that hold nothing."""
    with stock_of(sqlite).holding() as settings, stores(settings) as found:
        yield found


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Settings:
    """Settings of a service whose demonstration was begun, broken off, and finished as by `serve --demo`."""
    settings = Settings(data_folder=tmp_path_factory.mktemp("demonstration"))
    upgrade(settings.database)
    with stores(settings) as storage:
        begin(storage, sum(member.files for member in BEGUN))
    filling = serve._demonstration(settings)
    assert filling is not None
    filling.run(Event())
    assert filling.in_words == ""
    return settings


@pytest.fixture
def demonstration(served: Settings) -> Iterator[Storage]:
    """Stores that hold the demonstration fleet."""
    with stores(served) as found:
        yield found


def begin(storage: Storage, sessions: int = 1) -> None:
    """Fills until so many sessions are stored."""
    left = iter(range(sessions - 1))

    def break_off() -> None:
        if next(left, None) is None:
            raise InterruptedError

    with pytest.raises(InterruptedError):
        fill(storage, 2.0, break_off)


def test_the_files_are_the_same_every_time_and_say_that_they_are_simulated() -> None:
    for member in (CAST[0], *CAST[-2:]):
        first, again = list(files_of(member)), list(files_of(member))
        assert first == again
        assert len({file.content for file in first}) == member.files
        assert all(read_session(file.content).is_simulated for file in first)


def test_dates_are_irregular_and_in_order_over_three_years() -> None:
    for member in CAST:
        dates = [file.at for file in files_of(member)]
        gaps = [(b - a).days for a, b in pairwise(dates)]
        assert min(gaps) > 7
        assert len(set(gaps)) > 3
        assert (dates[0].year, dates[-1].year) == (2025 if member.joined else 2023, 2025 if member.left < 2 else 2026)


def test_the_fleet_shows_every_condition(demonstration: Storage) -> None:
    assert not is_wanted(demonstration)
    with demonstration.database.reading() as store:
        units = {unit.serial: unit for unit in Fleet(store).units(FleetQuery())}
        flags = [(flag.unit, flag.place, flag.state.value) for flag in Flags(store).page(FlagQuery())]
        notes = [note.text for serial in units for note in Notes(store).of_unit(serial)]
        stages = [session.stage for session in Sessions(store).of_unit("BA-109") if session.stage]
        breaks = {serial: Services(store).of_unit(serial) for serial in units}
        sessions = Sessions(store).wanted(SessionQuery(unit="BA-107", limit=50))
        stands = stand_health(store)
        outlooks = {serial: outlook_of(store, serial, END) for serial in units}
    assert {serial: units[serial].verdict for serial in CONDITIONS} == CONDITIONS
    assert ("BA-106", "A6", "acknowledged") in flags
    assert ("BA-107", "A4", "resolved") in flags
    assert any(state == "raised" for _, _, state in flags)
    assert notes == ["Moved to the other hangar by road."]
    assert stages == ["as-found", "as-left"]
    assert all(unit.simulated for unit in units.values())
    assert sum(unit.sessions for unit in units.values()) == FILES
    assert {serial for serial, found in breaks.items() if found} == {"BA-107", "BA-109"}
    assert [stand.stand for stand in stands if stand.has_shifted] == ["ODG-3"]
    assert outlooks["BG-201"].overdue
    assert any(t.step_dates for t in outlooks["BA-102"].trends if (t.sensor, t.parameter) == ("A5", "bias"))
    assert [s.is_reference for s in sessions].count(True) == 2, "a new reference after the service"


def test_a_unit_has_one_flag_at_most_and_none_where_it_is_fit_without_a_reservation(demonstration: Storage) -> None:
    """Faults of stands are flags of the stands."""
    update_outlooks(demonstration, END)
    flag_overdue(demonstration, END)
    flag_shifted_stands(demonstration, END)
    with demonstration.database.reading() as store:
        units = Fleet(store).units(FleetQuery())
        about = Counter(flag.scope for flag in Flags(store).page(FlagQuery(unresolved=True)))
    flags = {unit.serial: unit.flags for unit in units}
    fit = {unit.serial for unit in units if unit.verdict is Verdict.PASS and not unit.reservations}
    assert max(flags.values()) == 1, flags
    assert {serial: flags[serial] for serial in fit} == dict.fromkeys(fit, 0)
    assert {"BA-107", "BA-109"} <= fit
    assert {serial for serial in ("BA-105", "BA-106", "BA-111", "RT-301") if flags[serial]} == {
        "BA-105", "BA-106", "BA-111", "RT-301",
    }  # fmt: skip
    assert (about[Scope.UNIT], about[Scope.STAND]) == (sum(flags.values()), 3)


@pytest.mark.slow
def test_the_first_page_does_not_wait_for_the_fleet(tmp_path: Path) -> None:
    """It says how far the demonstration is; a service that stops meanwhile leaves one that the next start finishes."""
    with started(COMMAND, "serve", "--demo", "--port", 0, "--data-folder", tmp_path) as address:
        page = httpx.get(address, timeout=LONG)
    assert page.status_code == 200
    assert f"of {FILES} sessions." in page.text
    assert "data-follow" in page.text
    assert serve._demonstration(Settings(data_folder=tmp_path)) is not None


def test_it_is_filled_once_and_its_units_say_that_they_are_simulated(served: Settings) -> None:
    assert serve._demonstration(served) is None
    with serving(served) as address:
        fleet = httpx.get(f"{address}/api/v1/fleet").json()
        sessions = httpx.get(f"{address}/api/v1/sessions", params={"limit": 1000}).json()["sessions"]
    assert (fleet["units"], fleet["simulated"], len(sessions)) == (len(CAST), len(CAST), FILES)


def test_what_people_did_before_a_filling_was_broken_off_is_done_once(served: Settings) -> None:
    done = [(member, handled) for member in BEGUN for handled in member.handled]
    assert done
    assert any(member.remarks for member in BEGUN)
    with stores(served) as storage, storage.database.reading() as store:
        for member in BEGUN:
            assert len(Notes(store).of_unit(member.serial)) == len(member.remarks)
        for member, handled in done:
            flags = Flags(store).page(FlagQuery(unit=member.serial, matter=handled.matter))
            assert [change.text for flag in flags for change in flag.changes].count(handled.why) == 1


def test_every_unit_is_said_alike_everywhere(served: Settings, run: Run) -> None:
    """Compares its page, the list, its label, the calendar, the report, an export, HTTP and the terminal."""
    with serving(served) as url, httpx.Client(base_url=url) as client:
        for member in CAST:
            client.get(f"/api/v1/units/{member.serial}/usable").raise_for_status()  # its dates are worked out
        fleet = fleet_of(client)
        for member in CAST:
            answer = check_unit(client, member.serial, fleet)
            ran = run("usable", member.serial, "--server", url)
            assert ran.code == (0 if answer["usable"] else 1)
            assert answer["use"] in " ".join(ran.out.split())


def test_a_flight_shows_what_the_stand_has_not_seen_yet(empty: Storage) -> None:
    member = next(m for m in CAST if m.flown is not None)
    receipts = [upload(empty, file.content, file.name, file.at) for file in files_of(member)]
    assert Verdict.FAIL not in {r.verdict for r in receipts[:-1]}
    assert receipts[-1].verdict is Verdict.FAIL
    assert receipts[-1].reason.startswith("A2 has changed since the calibration: bias +1")


def test_only_an_empty_database_or_an_unfinished_demonstration_is_filled(empty: Storage) -> None:
    assert is_wanted(empty)
    begin(empty)
    assert is_wanted(empty)


def test_a_database_with_a_unit_of_somebody_else_is_left_alone(empty: Storage) -> None:
    first = next(files_of(CAST[0]))
    upload(empty, first.content, first.name, first.at)
    assert not is_wanted(empty)
