"""Raw logs of more cells than may be held, over HTTP: averaged while scanned, kept unchanged, never held."""

import json
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import httpx
import numpy as np
import pytest

from estimator.calibration.calibrate import averaged
from estimator.reading import read_session
from service.ingest import read_upload
from service.settings import Settings
from service.storage.landing import ARRIVING
from tests import builders
from tests.databases import one_engine
from tests.estimator.test_reading_csv import csv_of
from tests.patience import until
from tests.service.ingest.test_formats import parquet_bytes
from tests.serving import limited_client

WRITERS = {"csv": csv_of, "parquet": parquet_bytes}
CELLS = 20_000
"""Most that are held in these tests."""


def log(*, labelled=True, **changes):
    """A raw log of 100,000 cells."""
    return builders.raw_log(6, orientations=24, still=500, moving=40, labelled=labelled, **changes)


@pytest.fixture
def few_cells(settings: Settings) -> Iterator[Callable[..., httpx.Client]]:
    """A service that holds few cells."""
    with ExitStack() as stack:
        changed = {"cells": CELLS, "whole": 300_000}
        yield lambda **more: stack.enter_context(limited_client(settings, **changed | more))


def arriving(settings: Settings) -> list[Path]:
    """Files that were left half way."""
    return [path for path in (settings.files / ARRIVING).glob("*") if path.is_file()]


@one_engine
@pytest.mark.parametrize("labelled", [True, False])
@pytest.mark.parametrize("kind", WRITERS)
def test_a_long_log_is_averaged_as_a_short_one(few_cells, tmp_path: Path, kind: str, labelled: bool) -> None:
    few_cells()
    document = log(labelled=labelled)
    path = tmp_path / "log"
    path.write_bytes(WRITERS[kind](document))
    found, whole = read_upload(path, "log"), averaged(read_session(document))
    assert found.readings.shape == (24, 6)
    for name in ("readings", "standard_errors", "time", "vibration", "at_ends"):
        np.testing.assert_allclose(getattr(found, name), getattr(whole, name), rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("kind", WRITERS)
def test_a_long_log_is_stored_once_and_given_back_unchanged(few_cells, settings: Settings, kind: str) -> None:
    client, content = few_cells(), WRITERS[kind](log())
    first = client.post("/api/v1/sessions", files={"file": ("log", content)})
    again = client.post("/api/v1/sessions", files={"file": ("log", content)})
    assert (first.status_code, again.status_code, first.json()["id"]) == (201, 200, again.json()["id"])
    assert client.get(f"/api/v1/sessions/{first.json()['id']}/file").content == content
    assert arriving(settings) == []


@one_engine
def test_the_same_log_in_two_formats_is_one_session(few_cells) -> None:
    client = few_cells()
    answers = [client.post("/api/v1/sessions", files={"file": ("log", write(log()))}) for write in WRITERS.values()]
    assert [answer.status_code for answer in answers] == [201, 200]


@one_engine
def test_a_body_is_scanned_like_a_file_of_a_form_and_a_page(few_cells, settings: Settings) -> None:
    client = few_cells()
    body = client.post("/api/v1/sessions", content=csv_of(log()), headers={"content-type": "text/csv"})
    page = client.post("/upload", files={"files": ("log.parquet", parquet_bytes(log(seed=5)))})
    assert (body.status_code, page.status_code) == (201, 200)
    assert len(client.get("/api/v1/sessions").json()["sessions"]) == 2
    assert arriving(settings) == []


@one_engine
@pytest.mark.parametrize(
    "change",
    [
        {"sample_rate_hz": None},
        {"programme": "in-service"},
    ],
)
def test_a_long_file_that_is_no_raw_log_is_refused(few_cells, settings, change) -> None:
    document = {key: value for key, value in (log() | change).items() if value is not None}
    answer = few_cells().post("/api/v1/sessions", content=csv_of(document))
    assert (answer.status_code, answer.json()["problems"][0]["field"]) == (422, "file")
    assert "at most 300,000 can be read" in answer.json()["problems"][0]["message"]
    assert arriving(settings) == []


@one_engine
def test_a_json_of_that_length_is_stopped_as_it_comes(few_cells, settings: Settings) -> None:
    answer = few_cells().post("/api/v1/sessions", content=json.dumps(log()).encode())
    assert (answer.status_code, "300,000 bytes" in answer.json()["detail"]) == (413, True)
    assert arriving(settings) == []


@one_engine
@pytest.mark.parametrize(("name", "most", "status"), [("log", 400_000, 413), ("log_cells", 50_000, 422)])
def test_a_log_has_limits_too(few_cells, settings: Settings, name: str, most: int, status: int) -> None:
    answer = few_cells(**{name: most}).post("/api/v1/sessions", content=csv_of(log()))
    assert answer.status_code == status
    assert arriving(settings) == []


@one_engine
def test_a_faulty_cell_is_named_with_its_row_of_the_whole_log(few_cells) -> None:
    document = log()
    document["table"]["A3"][11_000] = "1.7x"
    answer = few_cells().post("/api/v1/sessions", content=csv_of(document))
    problem = answer.json()["problems"][0]
    assert (answer.status_code, problem["field"], problem["row"]) == (422, "A3", 11_001)


@one_engine
@pytest.mark.parametrize("kind", WRITERS)
def test_a_cell_without_a_number_is_left_out_of_the_whole_log(few_cells, kind: str) -> None:
    document = log()
    document["table"]["A3"][11_000] = float("inf") if kind == "parquet" else "n/a"
    answer = few_cells().post("/api/v1/sessions", content=WRITERS[kind](document))
    assert answer.status_code == 201
    assert answer.json()["remark"].startswith("No reading in 1 row (11001) of A3")


@one_engine
def test_blanks_semicolons_windows_lines_and_names_of_positions_are_read(few_cells, tmp_path: Path) -> None:
    few_cells()
    document = log()
    named = document | {"table": document["table"] | {"position": [f"p{k}" for k in document["table"]["position"]]}}
    named["table"]["position"] = [name.replace("p-1", "") for name in named["table"]["position"]]
    head, _, table = csv_of(named).partition(b"\ntime_s")
    path = tmp_path / "log"
    path.write_bytes(head + (b"\ntime_s" + table).replace(b",", b" ; ").replace(b"\n", b"\r\n"))
    found = read_upload(path, "log")
    np.testing.assert_allclose(found.readings, averaged(read_session(document)).readings, rtol=1e-9)


@one_engine
def test_a_changed_long_file_is_not_given_out(few_cells, settings: Settings) -> None:
    client = few_cells()
    id = client.post("/api/v1/sessions", content=csv_of(log())).json()["id"]
    (stored,) = settings.files.rglob(f"{id}*")
    stored.write_bytes(stored.read_bytes()[:-1] + b"7")
    assert client.get(f"/api/v1/sessions/{id}/file").status_code == 500


@one_engine
def test_a_sender_who_leaves_in_the_middle_leaves_nothing(few_cells, settings: Settings) -> None:
    client = few_cells()

    def cut() -> Iterator[bytes]:
        yield csv_of(log())
        raise ConnectionError

    with pytest.raises((ConnectionError, httpx.HTTPError)):
        client.post("/api/v1/sessions", content=cut())
    assert client.get("/api/v1/sessions").json()["sessions"] == []
    until(lambda: not arriving(settings))  # the service learns of it a moment after the sender
