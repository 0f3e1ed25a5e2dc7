"""Files made to do harm, all made by code: a few kilobytes that stand for gigabytes, or for hours.

Every one is refused with a sentence; ``says`` is what that holds.
"""

import json
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import h5py
import numpy as np
import polars as pl
from scipy.io import savemat

ENDLESS = Path(__file__).parents[2] / "tests" / "service" / "ingest" / "endless.h5"
"""File with a damaged tree that the library follows for ever."""
HEAD = {
    "format": "imu-session/1",
    "unit": "HOSTILE-1",
    "block": "accelerometer",
    "programme": "in-service",
    "started_at": "2026-03-01T09:00:00Z",
    "sample_rate_hz": 100.0,
    "sensors": [{"name": "A1", "nominal_axis": [1, 0, 0], "nominal_scale": 1.0, "reading_unit": "V"}],
}
"""Metadata of a session whose table does the harm."""


@dataclass(frozen=True)
class Hostile:
    """One file: its name, what makes it, and what the sentence of its refusal holds."""

    name: str
    make: Callable[[], bytes]
    says: str


def workbook(sheet: str, *, place: str = "xl/worksheets/sheet2.xml", more: dict[str, bytes] | None = None) -> bytes:
    """A workbook whose sheet `readings` holds this XML."""
    main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
    office = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    package = "http://schemas.openxmlformats.org/package/2006"
    parts = {
        "[Content_Types].xml": f'<Types xmlns="{package}/content-types"/>',
        "_rels/.rels": f'<Relationships xmlns="{package}/relationships"><Relationship Id="rId1" '
        f'Type="{office}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
        "xl/workbook.xml": f'<workbook xmlns="{main}" xmlns:r="{office}"><sheets>'
        '<sheet name="session" sheetId="1" r:id="rId1"/><sheet name="readings" sheetId="2" r:id="rId2"/>'
        "</sheets></workbook>",
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{package}/relationships">'
        f'<Relationship Id="rId1" Type="{office}/worksheet" Target="worksheets/sheet1.xml"/>'
        f'<Relationship Id="rId2" Type="{office}/worksheet" Target="/{place}"/></Relationships>',
        "xl/worksheets/sheet1.xml": f'<worksheet xmlns="{main}"><sheetData/></worksheet>',
        place: f'<worksheet xmlns="{main}"><sheetData>{sheet}</sheetData></worksheet>',
    }
    buffer = BytesIO()
    with ZipFile(buffer, "w", ZIP_DEFLATED) as archive:
        for name, text in {**parts, **(more or {})}.items():
            archive.writestr(name, text)
    return buffer.getvalue()


FAR = '<row r="1"><c r="A1"><v>1</v></c></row><row r="1048576"><c r="XFD1048576"><v>1</v></c></row>'
SHARED = b"<sst><si><t>" + b"n" * 1_000_000 + b"</t></si></sst>"


def shared_text() -> bytes:
    """A million cells that hold the same megabyte."""
    sheet = "".join(f'<row r="{j}"><c r="A{j}" t="s"><v>0</v></c></row>' for j in range(1, 200_001))
    return workbook(sheet, more={"xl/sharedStrings.xml": SHARED})


def parquet(frame: pl.DataFrame) -> bytes:
    """A table with the metadata of a session."""
    buffer = BytesIO()
    frame.write_parquet(buffer, metadata={"imu-session": json.dumps(HEAD)})
    return buffer.getvalue()


def hdf5(rows: int, columns: int) -> bytes:
    """Columns of equal numbers, packed."""
    buffer = BytesIO()
    with h5py.File(buffer, "w") as file:
        file.attrs["imu-session"] = json.dumps(HEAD)
        for k in range(columns):
            file.create_dataset(f"readings/c{k}", data=np.zeros(rows), compression="gzip", compression_opts=9)
    return buffer.getvalue()


def hdf5_never_written() -> bytes:
    """A terabyte that is declared only."""
    buffer = BytesIO()
    with h5py.File(buffer, "w") as file:
        file.attrs["imu-session"] = json.dumps(HEAD)
        file.create_dataset("readings/A1", (10**12,), "f8", chunks=(1000,))
    return buffer.getvalue()


def mat_bomb() -> bytes:
    """An element that unpacks to 300 MiB."""
    buffer = BytesIO()
    savemat(buffer, {"imu_session": json.dumps(HEAD)})
    pack = zlib.compressobj(9)
    packed = b"".join([pack.compress(bytes(1 << 20)) for _ in range(300)]) + pack.flush()
    return buffer.getvalue() + (15).to_bytes(4, "little") + len(packed).to_bytes(4, "little") + packed


def mat_many_cells() -> bytes:
    """Thirty million small numbers."""
    buffer = BytesIO()
    savemat(buffer, {"imu_session": json.dumps(HEAD), "A1": np.zeros((30_000_000, 1), np.int8)}, do_compression=True)
    return buffer.getvalue()


def with_table(table: str) -> bytes:
    """JSON whose table is this text."""
    return (json.dumps(HEAD)[:-1] + f', "table": {table}}}').encode()


def csv(table: str) -> bytes:
    """CSV with this text as its table."""
    return f"# {json.dumps(HEAD)}\n{table}".encode()


HOSTILE = (
    Hostile("xlsx-no-blank-before-r", lambda: workbook(FAR.replace(' r="XFD', ' t="n"r="XFD')), "damaged"),
    Hostile("xlsx-newline-before-r", lambda: workbook(FAR.replace(' r="XFD', '\nr = \n"XFD')), "1048576 rows"),
    Hostile(
        "xlsx-cells-without-r", lambda: workbook("<row>" + "<c/>" * 20_000 + '</row><row r="1048576"/>'), "columns"
    ),
    Hostile("xlsx-sheet-elsewhere", lambda: workbook(FAR, place="other/readings.xml"), "1048576 rows"),
    Hostile("xlsx-sheet-without-ending", lambda: workbook(FAR, place="other/readings"), "1048576 rows"),
    Hostile("xlsx-sheet-called-a-picture", lambda: workbook(FAR, place="xl/media/image1.png"), "cannot be read with"),
    Hostile("xlsx-row-of-a-million", lambda: workbook("<row>" + "<c><v>1</v></c>" * 1_000_000 + "</row>"), "columns"),
    Hostile("xlsx-unpacks", lambda: workbook("", more={"a.xml": b"<a>".ljust(150_000_000)}), "unpacks to more"),
    Hostile("xlsx-shared-text", shared_text, "far too much text"),
    Hostile(
        "xlsx-entities", lambda: workbook("", more={"a.xml": b"<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>"}), "damaged"
    ),
    Hostile("parquet-many-rows", lambda: parquet(pl.select(pl.repeat(1.0, 180_000_000).alias("A1"))), "180000000 rows"),
    Hostile(
        "parquet-long-texts",
        lambda: parquet(pl.select(pl.repeat("n" * 1_000_000, 150, dtype=pl.String).alias("A1"))),
        "far too much text|cannot be read with",
    ),
    Hostile("hdf5-many-cells", lambda: hdf5(5_000_000, 1), "5000000 rows"),
    Hostile("hdf5-many-columns", lambda: hdf5(1, 10_001), "10001 columns"),
    Hostile("hdf5-never-written", hdf5_never_written, "1000000000000 rows"),
    Hostile("hdf5-endless", ENDLESS.read_bytes, "cannot be read with|damaged"),
    Hostile("mat-unpacks", mat_bomb, "unpacks to more"),
    Hostile("mat-many-cells", mat_many_cells, "30000[0-9]* cells"),
    Hostile("json-empty-lists", lambda: with_table("[" + "[]," * 20_000_000 + "[]]"), "more than .* (cells|lists)"),
    Hostile("json-nested", lambda: with_table("[" * 5_000_000), "nested deeper"),
    Hostile("json-many-cells", lambda: with_table('{"A1": [' + "1," * 25_000_000 + "1]}"), "more than .* cells"),
    Hostile(
        "json-many-empty-texts", lambda: with_table('{"A1": [' + '"",' * 15_000_000 + '""]}'), "more than .* cells"
    ),
    Hostile("json-text-without-end", lambda: with_table('"' + '\\"' * 10_000_000), "not valid JSON"),
    Hostile("json-longest-number", lambda: with_table('{"A1": [' + "1" * 20_000_000 + "]}"), "thousands of digits"),
    Hostile("csv-many-rows", lambda: csv("A1\n" + "1.5\n" * 10_000_000), "10000000 rows"),
    Hostile("csv-many-columns", lambda: csv(",".join(f"c{k}" for k in range(10_001)) + "\n1"), "10001 columns"),
    Hostile(
        "csv-row-of-a-million",
        lambda: csv("A1,A2\n" + "1," * 10_000_000 + "1\n"),
        "where the header has 2|needs more than",
    ),
    Hostile("csv-quote-without-end", lambda: csv('A1,"A2\n' + "1,2\n" * 1_000_000), "quote is not closed|readable CSV"),
    Hostile("csv-empty-lines", lambda: csv("A1\n" + "\n" * 30_000_000 + "1"), "30000001 rows"),
)
"""All of them."""
