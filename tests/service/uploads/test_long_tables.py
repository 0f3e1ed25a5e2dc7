"""A long log in a layout of one's own: proposed from its beginning, read in parts once confirmed, as if read whole."""

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import httpx
import numpy as np
import polars as pl
import pytest

from estimator.errors import FormatError
from estimator.json_object import Json
from estimator.session import CalibrationSession
from service.ingest import read_upload
from service.ingest.jobs import look_at, session
from service.ingest.layout.facts import Rows, completed, facts_seen
from service.ingest.layout.sampling import HEAD
from service.ingest.layout.understand import SeenColumn, with_kinds
from service.ingest.long_log import averaged_if_long
from service.jobs import changes
from service.kit import limits
from service.settings import Settings
from tests.databases import one_engine
from tests.service.six_axis import Clock, by_hand, counted, moments, seconds, triad, written, xyz
from tests.service.uploads.test_layouts_page import sent, shown
from tests.serving import limited_client

HANDS = by_hand(rests=230)
EPOCH = 1_772_355_590


def log(
    clock: Clock = seconds,
    separator: str = ",",
    decimal: str = ".",
    change: Callable[[list[str]], None] = lambda _: None,
) -> bytes:
    """A log of 46,000 rows; ``change`` alters the cells of its last column."""
    last = triad(xyz("Gyro * (rad/s)"), HANDS.turning)
    change(last[-1][1])
    time = "Time" if ":" in clock(0) else "Time (ms)" if clock(0).isdecimal() else "Time (s)"
    columns = [(time, [clock(t) for t in HANDS.time]), *triad(xyz("Acc * (m/s²)"), HANDS.force), *last]
    return written([(name.replace(" ", "_"), cells) for name, cells in columns], separator, decimal)


LOGS = {
    "seconds": log(),
    "since 1970": log(counted(1e3, EPOCH * 1000)),
    "moments": log(moments("%Y-%m-%d %H:%M:%S.%f")),
    "past midnight": log(lambda t: moments("%H:%M:%S.%f")(t + 13.97 * 3600)),
    "decimal comma": log(lambda t: seconds(t).replace(".", "\\decimal"), ";", ","),
    "blanks": log(seconds, "  "),
    "quotes": log(change=lambda cells: cells.__setitem__(slice(None), [f'"{cell}"' for cell in cells])),
    "UTF-16": log().decode().encode("utf-16"),
    "marked gaps": log(change=lambda cells: cells.__setitem__(slice(500, 505), ["n/a", "-", "NaN", " ", ""])),
}
LOGS["headings again"] = LOGS["seconds"].replace(
    b"\n200.0000,", b"\n%s\n\na title\n200.0000," % LOGS["seconds"].split(b"\n")[0]
)


def mapping_of(path: Path) -> Json:
    """The mapping that is proposed, with the facts that no log states."""
    found = look_at(path, "log.csv")
    assert isinstance(found, dict)
    is_text = path.suffix != ".parquet"
    assert (found["sampled"], found["rows"]) == (is_text, pytest.approx(len(HANDS.time), abs=3))
    seen = [SeenColumn(**column) for column in found["columns"]]
    guesses = with_kinds(seen, ())
    columns = [guess.column for guess in guesses]
    facts = completed(facts_seen(guesses, seen, found["rows"]), Rows(columns, seen, found["rows"]))
    known = {**facts, "unit": "LOG-1", "started_at": "2026-03-01T09:00:00Z", "site": {"latitude_deg": 55.8}}
    return {"format": "imu-mapping/1", "table": found["taken"], "columns": columns, "session": known}


@pytest.fixture
def averaged(tmp_path: Path) -> Iterator[Callable[[bytes, int], CalibrationSession]]:
    """Reads a log within a number of cells."""
    usual, path = limits.in_force(), tmp_path / "log.csv"

    def read(content: bytes, cells: int) -> CalibrationSession:
        path.write_bytes(content)
        assert len(content) > HEAD
        limits.use(replace(usual, cells=cells))
        found = session(path, "log.csv", mapping_of(path))
        assert isinstance(found, CalibrationSession)
        return found

    yield read
    limits.use(usual)


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> CalibrationSession:
    """The positions of the log as a session file."""
    path = tmp_path_factory.mktemp("reference") / "log.csv"
    path.write_bytes(LOGS["seconds"])
    mapping, (_, *rows) = mapping_of(path), LOGS["seconds"].split(b"\n")
    metadata = json.dumps({**mapping["session"], "format": "imu-session/1"}).encode()
    names = ",".join(column["as"] for column in mapping["columns"]).encode()
    path.write_bytes(b"\n".join([b"# " + metadata, names, *rows]))
    usual = limits.in_force()
    limits.use(replace(usual, cells=300_000))
    found = session(path, "log.csv")
    limits.use(usual)
    assert isinstance(found, CalibrationSession)
    return found


@pytest.mark.parametrize("name", LOGS)
def test_it_is_read_in_parts_to_the_same_positions(averaged, reference: CalibrationSession, name: str) -> None:
    found = averaged(LOGS[name], 300_000)
    assert len(found.readings) == len(reference.readings) > 50
    np.testing.assert_allclose(found.readings, reference.readings, rtol=1e-9, atol=1e-9)
    assert found.time is not None
    np.testing.assert_allclose(found.time, reference.time, atol=2e-3)


def test_what_contradicts_its_beginning_is_named_by_column_and_line(averaged) -> None:
    with pytest.raises(FormatError) as refused:
        averaged(log(change=lambda cells: cells.__setitem__(44_998, "broken")), 300_000)
    (problem,) = refused.value.problems
    assert (problem.field, problem.row) == ("GZ", 44_999)
    assert str(problem.message).endswith("(column 'Gyro_Z_(rad/s)', line 45000 of the file)")


def test_what_many_rows_contradict_is_counted_by_rows_of_the_whole(averaged) -> None:
    with pytest.raises(FormatError) as refused:
        averaged(log(change=lambda cells: cells.__setitem__(slice(44_990, 44_999), ["broken"] * 9)), 300_000)
    *named, more = refused.value.problems
    assert [problem.row for problem in named] == [44_991, 44_992, 44_993, 44_994, 44_995]
    assert "4 more rows have this fault, up to row 44999; no later row was checked" in more.message


def test_a_log_that_is_averaged_in_one_piece_is_cut_in_parts_too(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_bytes(LOGS["marked gaps"])
    mapping = mapping_of(path)
    found, short = (
        averaged_if_long(path, path.name, mapping),
        read_upload(path.read_bytes(), path.name, mapping),
    )
    assert found is not None
    np.testing.assert_allclose(found.readings, short.readings, rtol=1e-9, atol=1e-9)
    assert found.screening == short.screening


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_what_only_begins_like_a_session_file_is_read_by_its_mapping(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"log.{suffix}"
    path.write_bytes(b"# a logger\n" + LOGS["seconds"])
    if suffix == "parquet":
        pl.read_csv(LOGS["seconds"]).write_parquet(path)
    found = session(path, path.name, mapping_of(path))
    assert isinstance(found, CalibrationSession)
    assert len(found.readings) > 50


@one_engine
def test_it_is_confirmed_on_the_page_and_read_by_a_job(settings: Settings) -> None:
    with limited_client(settings, cells=300_000, later=1_000_000) as client:
        stored = confirmed(client, LOGS["seconds"])
        assert stored.headers["location"] == "/jobs/1"
        job = client.get("/api/v1/jobs/1").json()
        assert (job["state"], job["problems"]) == ("done", [])
        address = f"/api/v1/sessions/{job['session']}"
        assert client.get(address).json()["unit"] == "LOG-1"
        assert LOGS["seconds"] in client.get(f"{address}/file").content


@one_engine
def test_it_stays_where_the_queue_is_full_so_that_it_can_be_confirmed_again(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    with limited_client(settings, cells=300_000, later=1_000_000) as client:
        with monkeypatch.context() as full:
            full.setattr(changes, "MOST_OPEN", 0)
            busy = confirmed(client, LOGS["seconds"])
        assert busy.status_code == 503
        assert "0 jobs wait already" in busy.text
        assert 'value="store"' in busy.text
        assert "Something is still missing" not in busy.text
        assert sent(client, shown(busy.text), do="store").headers["location"] == "/jobs/1"


def confirmed(client: httpx.Client, content: bytes) -> httpx.Response:
    """The answer after the page was filled in and stored."""
    card = shown(client.post("/upload", files={"files": ("log.csv", content)}).text)
    page = sent(client, {name: card[name] for name in ("filename", "aside")})
    facts = {"fact.unit": "LOG-1", "fact.day": "2026-03-01", "fact.site.latitude_deg": "55.8"}
    return sent(client, shown(sent(client, shown(page.text), **facts, do="look").text), do="store")
