"""The same content in any accepted format is the same session; damaged content is refused, never a crash."""

import json
from io import BytesIO

import h5py
import numpy as np
import polars as pl
import pytest
import xlsxwriter
from scipy.io import savemat

from estimator.errors import FormatError, SessionError
from estimator.reading import read_session
from service.ingest import read_upload
from service.ingest.digest import content_digest
from service.ingest.xlsx import letters_of
from tests import builders
from tests.estimator.test_reading_csv import csv_of, same


def metadata(document):
    return json.dumps({key: value for key, value in document.items() if key != "table"})


def rounded(document):
    """The document with 15 digits, which is what a spreadsheet keeps."""
    table = document["table"]
    for name, cells in table.items():
        table[name] = [float(f"{cell:.15g}") if isinstance(cell, float) else cell for cell in cells]
    return document


def json_bytes(document):
    return json.dumps(document).encode()


def parquet_bytes(document):
    buffer = BytesIO()
    pl.DataFrame(document["table"]).write_parquet(buffer, metadata={"imu-session": metadata(document)})
    return buffer.getvalue()


def key_values(node, way=""):
    """Rows of the session sheet: a dotted key and its value, lists of numbers as JSON."""
    if isinstance(node, dict):
        for key, child in node.items():
            yield from key_values(child, f"{way}.{key}" if way else key)
    elif isinstance(node, list) and isinstance(node[0], dict):
        for number, child in enumerate(node, start=1):
            yield from key_values(child, f"{way}[{number}]")
    else:
        yield way, json.dumps(node) if isinstance(node, list) else node


def xlsx_bytes(document):
    buffer = BytesIO()
    with xlsxwriter.Workbook(buffer) as book:
        session, readings = book.add_worksheet("session"), book.add_worksheet("readings")
        for j, row in enumerate(key_values({k: v for k, v in document.items() if k != "table"})):
            session.write_row(j, 0, row)
        for k, (name, cells) in enumerate(document["table"].items()):
            readings.write_column(0, k, [name, *cells])
    return buffer.getvalue()


def hdf5_bytes(document):
    buffer = BytesIO()
    with h5py.File(buffer, "w") as file:
        file.attrs["imu-session"] = metadata(document)
        for name, cells in document["table"].items():
            text = any(isinstance(cell, str) for cell in cells)
            file[f"readings/{name}"] = [c or "" for c in cells] if text else np.array(cells, dtype=float)
    return buffer.getvalue()


def mat_bytes(document):
    columns = {
        name: np.array([c or "" for c in cells]) if any(isinstance(c, str) for c in cells) else np.array(cells, float)
        for name, cells in document["table"].items()
    }
    buffer = BytesIO()
    savemat(buffer, {"imu_session": metadata(document), **columns}, do_compression=True, oned_as="column")
    return buffer.getvalue()


WRITERS = {
    "json": json_bytes,
    "csv": csv_of,
    "parquet": parquet_bytes,
    "xlsx": xlsx_bytes,
    "hdf5": hdf5_bytes,
    "mat": mat_bytes,
}


@pytest.mark.parametrize("build", builders.EVERY)
@pytest.mark.parametrize("kind", WRITERS)
def test_every_format_gives_the_same_session(kind, build):
    document = rounded(build())
    assert same(read_upload(WRITERS[kind](document), f"x.{kind}"), read_session(document))


@pytest.mark.parametrize("kind", WRITERS)
def test_a_simulated_session_is_one_in_every_format(kind):
    document = rounded(builders.accelerometer_block(3)) | {"origin": "simulated"}
    session = read_upload(WRITERS[kind](document), f"x.{kind}")
    assert (session.is_simulated, content_digest(session)) == (True, content_digest(read_session(document)))


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize("stated", [{"powered_on_at": "2026-03-01T08:20:00Z"}, {"time_since_power_on_s": 2400.0}])
def test_when_the_unit_was_switched_on_survives_every_format(kind, stated):
    document = rounded(builders.accelerometer_block(3)) | stated
    session = read_upload(WRITERS[kind](document), f"x.{kind}")
    assert session.time_since_power_on == 2400.0
    assert (
        content_digest(session)
        == content_digest(read_session(document))
        != content_digest(read_session(rounded(builders.accelerometer_block(3))))
    )


@pytest.mark.parametrize("kind", WRITERS)
def test_where_sensors_sit_and_how_pulses_are_counted_survive_every_format(kind):
    document = builders.gyro_block() | {"counter": "reset"}
    document["sensors"][2]["position_m"] = [0.01, -0.02, 0.0]
    session = read_upload(WRITERS[kind](document), "x")
    assert (session.counter, session.sensors[2].position.tolist()) == ("reset", [0.01, -0.02, 0.0])
    assert session.sensors[0].position is None


@pytest.mark.parametrize("kind", WRITERS)
def test_empty_cells_survive_every_format(kind):
    document = rounded(builders.arbitrary_orientations())
    document["table"]["A1_se"][3] = None
    document["table"]["position"] = ["p1", *["p2"] * 22, None]
    assert same(read_upload(WRITERS[kind](document), "x"), read_session(document))


@pytest.mark.parametrize("kind", WRITERS)
def test_a_fault_has_its_row_in_every_format(kind):
    document = builders.accelerometer_block()
    document["table"]["A3_se"][6] = -1.0
    with pytest.raises(FormatError, match=f"tuesday.{kind}: A3_se, row 7: is -1") as caught:
        read_upload(WRITERS[kind](document), f"tuesday.{kind}")
    assert len(caught.value.problems) == 1


@pytest.mark.parametrize("kind", WRITERS)
def test_a_file_cut_short_is_refused(kind):
    content = WRITERS[kind](builders.accelerometer_block())
    for size in (4, 8, 200, len(content) // 2, len(content) - 9):
        with pytest.raises(SessionError):
            read_upload(content[:size], "x")


def test_a_fault_in_a_workbook_names_its_cell():
    document = builders.accelerometer_block()
    document["table"]["A2"][4] = "none"
    document["site"] = {"latitude_deg": 95.0}
    with pytest.raises(FormatError) as caught:
        read_upload(xlsx_bytes(document), "x.xlsx")
    said = {problem.field: problem.message for problem in caught.value.problems}
    column = letters_of(list(document["table"]).index("A2") + 1)
    assert f"(cell {column}6 of the sheet readings)" in said["A2"]
    line = [key for key, _ in key_values(document)].index("site.latitude_deg") + 1
    assert f"(cell B{line} of the sheet session)" in said["site.latitude_deg"]


@pytest.mark.parametrize(("number", "letters"), [(1, "A"), (26, "Z"), (27, "AA"), (703, "AAA")])
def test_columns_are_named_as_a_spreadsheet_names_them(number, letters):
    assert letters_of(number) == letters
