"""Tables of a workbook, as other programs read them."""

from datetime import UTC, datetime
from io import BytesIO
from zipfile import ZipFile

import polars as pl
import pytest
from lxml import etree

from service.papers.sheets import CellKind, Column, Workbook

NOW = datetime(2026, 11, 21, 12, 30, 30, tzinfo=UTC)
COLUMNS = (
    Column("Text", is_named=True), Column("Number", CellKind.CHANGE), Column("Time", CellKind.TIME),
    Column("Yes or no"),
)  # fmt: skip
MAIN = {"m": "http://schemas.openxmlformats.org/spreadsheetml/2006/main"}


def made(*rows: tuple[str | float | datetime | bool | None, ...]) -> bytes:
    """One sheet with these rows, and an empty one behind it."""
    target = BytesIO()
    book = Workbook(target, NOW, "Tables")
    book.table("First", COLUMNS, rows)
    book.table("Second", COLUMNS, ())
    book.close()
    return target.getvalue()


def styled(content: bytes, cell: str) -> tuple[str, str | None]:
    """The number format of a cell, and whether it is marked as text that looks like a formula."""
    with ZipFile(BytesIO(content)) as file:
        sheet, styles = (etree.fromstring(file.read(f"xl/{part}.xml")) for part in ("worksheets/sheet1", "styles"))
    (number,) = sheet.xpath(f"//m:c[@r='{cell}']/@s", namespaces=MAIN)
    look = styles.xpath("//m:cellXfs/m:xf", namespaces=MAIN)[int(number)]
    own = styles.xpath(f"//m:numFmt[@numFmtId='{look.get('numFmtId')}']/@formatCode", namespaces=MAIN)
    return (own or [look.get("numFmtId")])[0], look.get("quotePrefix")


@pytest.mark.parametrize(
    "text",
    ["a & <b>", "  spaced ", "line\nbreak", "_x0041_", "µg·√h", "=1+1", "17", "x" * 300, "<r>a</r>", "<r><b & </r>"],
)
def test_a_text_is_read_as_it_was_written(text: str) -> None:
    assert pl.read_excel(BytesIO(made((text, None, None, None))), sheet_name="First")["Text"].to_list() == [text]


def test_characters_that_no_file_holds_are_escaped_as_the_standard_says() -> None:
    with ZipFile(BytesIO(made(("bell\x07, \ufffe, _x0007_", None, None, None)))) as file:
        assert "bell_x0007_, _xFFFE_, _x005F_x0007_" in file.read("xl/worksheets/sheet1.xml").decode()


def test_numbers_dates_and_answers_keep_their_kind() -> None:
    rows = ("a", 1.25e-7, NOW, True), ("b", -3, NOW, False), ("c", float("nan"), None, None)
    table = pl.read_excel(BytesIO(made(*rows)), sheet_name="First")
    assert table["Number"].to_list() == [1.25e-7, -3.0, None]
    assert table["Time"].to_list() == [NOW.replace(tzinfo=None), NOW.replace(tzinfo=None), None]
    assert table["Yes or no"].to_list() == ["yes", "no", None]


def test_every_cell_has_the_look_of_its_column() -> None:
    content = made(("=1+1", 1.0, NOW, True), ("plain", 1.0, NOW, True))
    assert styled(content, "A2")[1] == "1"
    looks = [styled(content, cell) for cell in ("A3", "B3", "C3")]
    assert looks == [("@", None), ("0.00", None), ("yyyy-mm-dd hh:mm", None)]


def test_a_sheet_says_how_far_it_reaches() -> None:
    with ZipFile(BytesIO(made(*[("a", 1.0, NOW, True)] * 7))) as file:
        sheets = [etree.fromstring(file.read(f"xl/worksheets/sheet{k}.xml")) for k in (1, 2)]
    assert [s.xpath("string(//m:dimension/@ref)", namespaces=MAIN) for s in sheets] == ["A1:D8", "A1:D1"]
    assert [len(s.xpath("//m:row", namespaces=MAIN)) for s in sheets] == [8, 1]
