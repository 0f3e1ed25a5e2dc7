"""The register: units before their first session, where they are and who has them, and retired ones."""

import csv
import io
import tracemalloc
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from typing import Any

import httpx
import pytest

from service.errors import ConflictError, RefusedError
from service.flags.store import FlagQuery, Flags
from service.fleet.records import FleetQuery, Order
from service.fleet.store import Fleet
from service.fleet.uses_store import Uses
from service.judging.usable_reading import usable_unit
from service.outlook.store import Outlooks
from service.records import register
from service.records.register import PIECE, Entering, enter, move_unit
from service.storage import Storage
from service.storage.queries import Store
from service.types.store import UnitTypes
from service.units.records import CustodyStep, Move, NewEntry, Registered
from service.units.register_file import read_register
from service.units.store import Register
from service.uploads.receive import upload
from service.web.turns import RegisterTurns
from tests.conftest import Filled, Holding
from tests.databases import all_on_both_engines as pytest_generate_tests  # noqa: F401 - the hook
from tests.databases import one_engine
from tests.service.dated import upload_and_date
from tests.service.made_sessions import FAILED, session_bytes
from tests.service.papers.documents import text_of

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
BY = Entering("K. Ito", NOW)
NEW = NewEntry("BA-900", "new type", "Aero Works", "Hangar 2", "M. Sato", "spare")
RETIRE, RETURN = Move(remark="scrapped", step=CustodyStep.RETIRED), Move(remark="after all", step=CustodyStep.RETURNED)


def listed(store: Store, query: FleetQuery = FleetQuery()) -> list[str]:  # noqa: B008 - frozen
    """Serial numbers of a list."""
    return [unit.serial for unit in Fleet(store).units(query)]


def one_failed(storage: Storage) -> None:
    """BA-017 is unfit; BA-900 is registered."""
    for content in FAILED:
        upload_and_date(storage, content, "a.json", NOW)
    enter(storage, (NEW,), BY)


@pytest.fixture
def storage(filled: Filled) -> Storage:
    """Both."""
    return filled(one_failed)


def test_a_registered_unit_is_in_the_fleet_without_a_calibration(storage: Storage) -> None:
    with storage.database.reading() as store:
        assert listed(store) == ["BA-017", "BA-900"]
        assert (
            listed(store, FleetQuery(uncalibrated=True)) == listed(store, FleetQuery(location="Hangar 2")) == ["BA-900"]
        )
        condition = Fleet(store).condition_at(NOW)
        assert (condition.units, condition.uncalibrated, sum(condition.verdicts.values())) == (2, 1, 1)
        assert sum(sum(counts.values()) for counts in Uses(store).by_type_at(NOW).values()) == 2
        assert not usable_unit(store, "BA-900", NOW).usable
        assert Fleet(store).choices().custodians == ("M. Sato",)


def test_its_first_session_says_what_its_type_is(storage: Storage) -> None:
    content = session_bytes(unit="BA-900", unit_type="new type")
    upload(storage, content, "a.json", NOW)
    with storage.database.reading() as store:
        known = UnitTypes(store).get("new type")
        assert len(known.sensors) == 6
        assert known.tolerances.bias is not None
        assert Fleet(store).condition().uncalibrated == 0
        assert Register(store).get("BA-900").location == "Hangar 2"


def test_a_session_of_another_type_corrects_the_register(storage: Storage) -> None:
    upload(storage, session_bytes(unit="BA-900", origin="simulated"), "a.json", NOW)
    with storage.database.reading() as store:
        unit = Fleet(store).unit("BA-900")
        other = Fleet(store).unit("BA-017")
    assert unit is not None
    assert other is not None
    assert (unit.unit_type, unit.simulated) == (other.unit_type, True)


def test_a_move_is_kept_with_what_was_before(storage: Storage) -> None:
    move_unit(storage, "BA-900", Move(location="Hangar 3", remark="by road"), "R. Duarte", NOW)
    with storage.database.reading() as store:
        moved, entered = Register(store).history("BA-900")
    assert (moved.location_before, moved.location, moved.custodian, moved.who) == (
        "Hangar 2",
        "Hangar 3",
        "M. Sato",
        "R. Duarte",
    )
    assert (entered.step, entered.location_before, entered.location) == (CustodyStep.ENTERED, "", "Hangar 2")
    with pytest.raises(ConflictError, match="there already"):
        move_unit(storage, "BA-900", Move(location="Hangar 3"), "R. Duarte", NOW)
    with pytest.raises(RefusedError):
        move_unit(storage, "BA-900", Move(location="Hangar 4"), "K. Ito", NOW, at=NOW + timedelta(days=3))


def seen(storage: Storage, at: datetime) -> tuple[Any, ...]:
    """List, counts, flags and tallies of the fleet."""
    with storage.database.reading() as store:
        fleet, flags = Fleet(store), Flags(store).page(FlagQuery())
        return listed(store), fleet.condition_at(at), flags, fleet.tallies()


def test_a_retired_unit_leaves_lists_counts_due_dates_and_flags_and_comes_back(storage: Storage) -> None:
    late = NOW + timedelta(days=4000)
    with storage.database.reading() as store:
        before = (
            listed(store),
            Fleet(store).condition_at(late),
            Flags(store).page(FlagQuery()),
            Fleet(store).tallies(),
        )
    assert before[2]
    move_unit(storage, "BA-017", RETIRE, "K. Ito", NOW)
    with storage.database.reading() as store:
        assert listed(store) == ["BA-900"]
        assert listed(store, FleetQuery(retired=True)) == ["BA-017"]
        assert listed(store, FleetQuery(retired=None)) == ["BA-017", "BA-900"]
        condition = Fleet(store).condition_at(late)
        assert (condition.units, condition.flags, condition.overdue) == (1, 0, 0)
        assert Fleet(store).tallies() == ()
        assert Flags(store).page(FlagQuery()) == ()
        assert Flags(store).page(FlagQuery("BA-017"))
        assert Outlooks(store).due(10) == Outlooks(store).overdue_units(late) == ()
        assert usable_unit(store, "BA-017", NOW).why == "It is retired since 21 Nov 2026."
    with pytest.raises(ConflictError, match="retired since 21 Nov 2026 already"):
        move_unit(storage, "BA-017", RETIRE, "K. Ito", NOW)
    move_unit(storage, "BA-017", RETURN, "K. Ito", NOW)
    assert seen(storage, late) == before


def test_a_session_of_a_retired_unit_is_taken_and_says_so(storage: Storage) -> None:
    move_unit(storage, "BA-017", RETIRE, "K. Ito", NOW)
    receipt = upload(storage, session_bytes(seed=9, month=9), "a.json", NOW)
    assert receipt.created
    assert receipt.remark.startswith("BA-017 is retired since 21 Nov 2026")
    with storage.database.reading() as store:
        assert listed(store) == ["BA-900"]


CSV = "serial;unit_type;location;custodian;note\nBA-017;;Lab;K. Ito;'=1\nBA-901;RA-9;Hangar 1;;\n"


def test_a_table_is_imported_whole_and_again_changes_nothing(storage: Storage) -> None:
    entries = read_register(CSV.encode("utf-8-sig"), "register.csv")
    assert vars(enter(storage, entries, BY)) == {"new": 1, "changed": 1, "unchanged": 0}
    assert vars(enter(storage, entries, BY)) == {"new": 0, "changed": 0, "unchanged": 2}
    with storage.database.reading() as store:
        known = Register(store).get("BA-017")
        assert (known.location, known.note, known.owner) == ("Lab", "=1", "")
        assert len(Register(store).history("BA-017")) == 1


def test_a_table_with_a_wrong_row_leaves_everything_as_it_was(storage: Storage) -> None:
    table = "serial,unit_type\nBA-902,RA-9\nBA-903,\nBA-017,another\n"
    with pytest.raises(RefusedError) as refused:
        enter(storage, read_register(table.encode(), "a.csv"), BY)
    assert [(p.row, p.field) for p in refused.value.problems] == [(2, "unit_type"), (3, "unit_type")]
    with storage.database.reading() as store:
        assert listed(store) == ["BA-017", "BA-900"]


@pytest.mark.parametrize(
    ("table", "places"),
    [
        ("unit,where\nA,B\n", {("unit", None), ("where", None), ("serial", None)}),
        ("serial,unit_type\nA,B\nA,B\n", {("serial", 2)}),
        (f"serial,unit_type\nA,{'x' * 201}\n", {("unit_type", 1)}),
        ("serial,unit_type\n", {("file", None)}),
        ('serial,unit_type\n"A,B\n', {("file", None)}),
        ("Serial,serial\nA,B\n", {("file", None)}),
    ],
)
def test_every_fault_of_a_table_is_listed_by_row_and_column(table: str, places: set[tuple[str, int | None]]) -> None:
    with pytest.raises(RefusedError) as refused:
        read_register(table.encode(), "a.csv")
    assert {(p.field, p.row) for p in refused.value.problems} == places


def test_others_write_while_a_long_list_is_entered(http: httpx.Client) -> None:
    table = "serial,unit_type,location\n" + "".join(f"U-{n},RA-{n % 7},Hangar {n}\n" for n in range(500))
    note = {"text": "moved by road", "by": "K. Ito"}
    with ThreadPoolExecutor(1) as pool:
        sent = pool.submit(http.post, "/api/v1/register", files={"file": ("r.csv", table)}, data={"by": "K. Ito"})
        written = 0
        while not sent.done():
            written += http.post("/api/v1/units/BA-017/notes", json=note).status_code == 201
    assert sent.result().json() == {"new": 500, "changed": 0, "unchanged": 0}
    assert written > 2


def test_of_many_registers_at_once_some_wait_and_the_rest_come_again(http: httpx.Client) -> None:
    def send(number: int) -> httpx.Response:
        rows = "\n".join(f"S-{number}-{n},T" for n in range(8 * PIECE))
        form = {"files": {"file": ("units.csv", f"serial,unit_type\n{rows}")}, "data": {"by": "K. Ito"}}
        return http.post("/api/v1/register", **form)

    together = RegisterTurns.at_once + RegisterTurns.most_waiting
    with ThreadPoolExecutor(3 * together) as pool:
        answers = list(pool.map(send, range(3 * together)))
    refused = [answer for answer in answers if answer.status_code == 503]
    assert all(int(answer.headers["Retry-After"]) > 0 for answer in refused)
    assert 0 < len(refused) <= 2 * together
    assert {answer.status_code for answer in answers if answer not in refused} == {200}


def test_a_list_that_somebody_makes_wrong_meanwhile_says_what_is_entered(
    storage: Storage, monkeypatch: pytest.MonkeyPatch
) -> None:
    entries = tuple(NewEntry(f"U-{n:02d}", "RA-9") for n in range(2 * PIECE))
    known = register._known

    def changed_meanwhile(store: Store, rows: Sequence[tuple[int, NewEntry]], refusal: str) -> dict[str, Registered]:
        is_second = len(rows) == PIECE and rows[0][1].serial == f"U-{PIECE:02d}"
        return known(store, [(n, replace(e, unit_type="")) for n, e in rows] if is_second else rows, refusal)

    monkeypatch.setattr(register, "_known", changed_meanwhile)
    with pytest.raises(RefusedError, match=f"{PIECE} of {2 * PIECE} units are entered"):
        enter(storage, entries, BY)
    monkeypatch.undo()
    assert vars(enter(storage, entries, BY)) == {"new": PIECE, "changed": 0, "unchanged": PIECE}


@one_engine
def test_a_name_with_a_semicolon_is_one_cell_and_no_formula_and_is_read_back(http: httpx.Client) -> None:
    entry = {"unit_type": "RA-9", "location": "Hangar 2;=1+1", "custodian": "=2;@3", "by": "K. Ito"}
    assert http.put("/api/v1/units/BA-900/register", json=entry).status_code == 200
    table = http.get("/api/v1/register?format=csv").text
    row = next(row for row in csv.DictReader(io.StringIO(table)) if row["serial"] == "BA-900")
    assert (row["location"], row["custodian"]) == ("Hangar 2;'=1+1", "'=2;'@3")
    assert '"Hangar 2;' in table
    for cells in csv.reader(io.StringIO(table), delimiter=";"):
        assert not any(cell.startswith(("=", "+", "-", "@")) for cell in cells)
    sent = http.post("/api/v1/register", files={"file": ("r.csv", table)}, data={"by": "K. Ito"})
    assert sent.json() == {"new": 0, "changed": 1, "unchanged": 1}


HEADINGS = ",".join(f"h{number}" for number in range(20_000))
TOO_LARGE = {
    "wide and short rows": f"serial,{HEADINGS}\n" + 2000 * "a\n",
    "headings": "serial," + ",".join(map(hex, range(90_000))) + "\na\n",
    "commas": 1_000_000 * "," + "\n1,2\n",
    "commas without an end": 1_000_000 * ",",
    "rows of commas": 500 * (2000 * "," + "\n"),
    "rows": "serial\n" + 2_000_000 * "a\n",
    "one quoted cell": 'serial,note\n"' + 1_000_000 * "a;",
    "headings of one row after another": 2000 * '"\n",' + "a\n",
}


@one_engine
@pytest.mark.parametrize("name", TOO_LARGE)
@pytest.mark.parametrize("path", ["/api/v1/register", "/register/import"])
def test_a_table_that_is_too_large_is_refused_before_it_is_built(http: httpx.Client, name: str, path: str) -> None:
    tracemalloc.start()
    sent = http.post(path, files={"file": ("r.csv", TOO_LARGE[name])}, data={"by": "K. Ito"})
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert (sent.status_code, "r.csv" in sent.text) == (422, True)
    assert len(sent.content) < 50_000
    assert most < 20 * len(TOO_LARGE[name]) + 20_000_000


@one_engine
def test_of_many_faults_the_first_are_named_and_the_others_counted(http: httpx.Client) -> None:
    for table in ("serial,note\n" + 900 * f"A,{2001 * 'x'}\n", "serial\n" + "".join(f"A{n}\n" for n in range(900))):
        sent = http.post("/api/v1/register", files={"file": ("r.csv", table)}, data={"by": "K. Ito"})
        problems = sent.json()["problems"]
        assert (len(problems), "more problems" in problems[-1]["message"]) == (501, True)


@pytest.fixture
def http(holding: Holding) -> httpx.Client:
    """HTTP to a service with one unit."""
    return holding(session_bytes())


def test_the_register_over_http(http: httpx.Client) -> None:
    entry = {"unit_type": "RA-9", "location": "Hangar 2", "by": "K. Ito"}
    assert http.put("/api/v1/units/BA-900/register", json=entry).json()["history"][0]["step"] == "entered"
    moved = http.post("/api/v1/units/BA-900/moves", json={"custodian": "M. Sato", "by": "K. Ito"})
    assert (moved.status_code, moved.json()["custodian"], moved.json()["location"]) == (201, "M. Sato", "Hangar 2")
    assert http.post("/api/v1/units/BA-900/retire", json={"why": "lost", "by": "K. Ito"}).json()["retired_at"]
    assert [u["serial"] for u in http.get("/api/v1/units").json()["units"]] == ["BA-017"]
    assert [u["serial"] for u in http.get("/api/v1/units?retired=true").json()["units"]] == ["BA-900"]
    assert http.post("/api/v1/units/BA-900/return", json={"why": "found", "by": "K. Ito"}).json()["retired_at"] is None
    table = http.get("/api/v1/register?format=csv").text
    assert '\nBA-900,RA-9,"",Hangar 2,M. Sato,"",""\n' in table
    changed = table.replace("Hangar 2", "Hangar 7")
    sent = http.post("/api/v1/register", files={"file": ("r.csv", changed)}, data={"by": "K. Ito"})
    assert sent.json() == {"new": 0, "changed": 2, "unchanged": 0}
    refused = http.post("/api/v1/register", files={"file": ("r.csv", "serial\n\n")}, data={"by": "K. Ito"})
    assert refused.status_code == 422


def posted(http: httpx.Client, what: str, form: dict[str, str]) -> str:
    """The page after a form of the unit."""
    return http.post(f"/units/BA-900/{what}", data=form, follow_redirects=True).text


def test_the_register_by_page(http: httpx.Client) -> None:
    form = {"serial": "BA-900", "unit_type": "RA-9", "location": "Hangar 2", "by": "K. Ito"}
    page = http.post("/register", data=form, follow_redirects=True)
    assert "None of its sessions counts as a calibration" in page.text
    assert "Hangar 2" in page.text
    form = {"location": "Hangar 3", "custodian": "M. Sato", "by": "K. Ito"}
    assert "Hangar 2 → Hangar 3" in posted(http, "moves", form)
    assert "BA-900" in http.get("/?condition=none&location=Hangar+3").text
    retired = posted(http, "retire", {"why": "scrapped", "by": "K. Ito"})
    assert "Retired since" in retired
    assert "BA-900" not in http.get("/").text
    assert "BA-900" in http.get("/?retired=only").text
    sent = {"files": ("a.json", session_bytes(seed=5, unit="BA-900"))}
    assert "BA-900 is retired since" in http.post("/upload", files=sent).text
    [session] = http.get("/api/v1/sessions?unit=BA-900").json()["sessions"]
    assert "BA-900 is retired since" in http.get(f"/sessions/{session['id']}").text
    assert "retired since" in text_of(http.get("/api/v1/units/BA-900/label.pdf").content)
    assert "Retired since" in text_of(http.get("/api/v1/units/BA-900/status.pdf").content)
    assert "Retired since" not in posted(http, "return", {"why": "found", "by": "K. Ito"})
    assert "is retired" not in http.get(f"/sessions/{session['id']}").text
    table = {"file": ("r.csv", "serial,unit_type\nX-1,RA-9\n")}
    assert "New units: 1" in http.post("/register/import", files=table, data={"by": "K. Ito"}).text
    wrong = {"file": ("r.csv", "serial,unit_type\nX-2,\n")}
    assert http.post("/register/import", files=wrong, data={"by": "K. Ito"}).status_code == 422
    assert http.get("/unit-types/RA-9").status_code == 200
    assert http.get("/unit-types").status_code == 200


@pytest.mark.parametrize("order", Order)
@pytest.mark.parametrize("backwards", [False, True])
def test_a_list_is_read_on_past_units_without_a_calibration(storage: Storage, order: Order, backwards: bool) -> None:
    enter(storage, (NewEntry("BA-899", "RA-9"), NewEntry("BA-901", "RA-9")), BY)
    wanted = FleetQuery(order=order, backwards=backwards)
    with storage.database.reading() as store:
        whole, read = listed(store, wanted), listed(store, replace(wanted, limit=1))
        while len(read) < len(whole):
            read += listed(store, replace(wanted, after=read[-1], limit=1))
        assert read == whole
        assert listed(store, replace(wanted, before=whole[-1])) == whole[:-1]
    assert len(whole) == 4
