"""Files that are no table at all: each is called by its name, with what to send instead."""

import zipfile
from io import BytesIO
from pathlib import Path

import httpx
import pytest

from estimator.errors import FormatError
from service.ingest import look_at, read_file
from tests.databases import one_engine
from tests.service import tables


def archive(*names: str) -> bytes:
    buffer = BytesIO()
    with zipfile.ZipFile(buffer, "w") as file:
        for name in names:
            file.writestr(name, "application/vnd.oasis.opendocument.spreadsheet" if name == "mimetype" else "<x/>")
    return buffer.getvalue()


FOREIGN = {
    "photo.jpg": (b"\xff\xd8\xff\xe0\x00\x10JFIF" + bytes(range(256)), "picture (JPEG)"),
    "shot.csv": (b"\x89PNG\r\n\x1a\n" + bytes(range(256)), "picture (PNG)"),
    "photo.heic": (b"\x00\x00\x00\x18ftypheic" + bytes(range(256)), "picture"),
    "scan.pdf": (b"%PDF-1.7\n%\xe2\xe3", "PDF"),
    "page.html": (b"\n<!DOCTYPE html><html><table><tr><td>1</td></tr></table></html>", "web page"),
    "old.xls": (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600), "97–2003"),
    "letter.docx": (archive("[Content_Types].xml", "word/document.xml"), "Word document (DOCX)"),
    "table.ods": (archive("mimetype", "content.xml"), "OpenDocument"),
    "files.zip": (archive("a.csv", "b.csv"), "packed archive"),
    "log.gz": (b"\x1f\x8b\x08\x00" + bytes(40), "packed archive"),
}


@pytest.mark.parametrize("name", FOREIGN)
def test_a_file_of_another_kind_is_called_by_its_name(name: str, tmp_path: Path) -> None:
    content, said = FOREIGN[name]
    file = tmp_path / name
    file.write_bytes(content)
    for read in (lambda: look_at(content, name), lambda: read_file(file)):
        with pytest.raises(FormatError) as caught:
            read()
        (problem,) = caught.value.problems
        assert said in problem.message
        assert "upload" in problem.message


def test_bytes_that_are_nothing_are_said_to_be_no_text() -> None:
    with pytest.raises(FormatError, match="neither text nor in a known format"):
        look_at(bytes([129, 141, 143, 1]) * 50, "noise.dat")


@one_engine
@pytest.mark.parametrize("kind", ["csv", "xlsx"])
def test_a_table_of_ones_own_without_a_mapping_is_sent_to_the_page(client: httpx.Client, kind: str) -> None:
    document = tables.own_document()
    content = tables.text_table(document).encode("cp1251") if kind == "csv" else tables.xlsx_table(document)
    answer = client.post("/api/v1/sessions", files={"file": (f"own.{kind}", content)})
    (problem,) = answer.json()["problems"]
    assert (answer.status_code, "--mapping FILE" in problem["message"]) == (422, True)
    assert "upload page" in problem["message"]


@one_engine
def test_text_without_a_row_of_numbers_is_no_session_without_metadata(client: httpx.Client) -> None:
    answer = client.post("/api/v1/sessions", files={"file": ("notes.txt", b"Dear colleague,\nsee below.\n")})
    assert "no row of numbers" in answer.json()["problems"][0]["message"]


@one_engine
def test_the_page_counts_a_batch_and_shows_first_what_needs_a_person(client: httpx.Client) -> None:
    table, good = tables.text_table(tables.own_document()).encode(), tables.xlsx_table(tables.own_document())
    files = [("files", (name, content)) for name, content in (("t.csv", table), ("t.xlsx", good), ("p.pdf", b"%PDF-"))]
    page = client.post("/upload", files=files).text
    assert "Failed: <b>1</b>." in page
    assert "To be checked or being read: <b>2</b>." in page
    assert page.index("p.pdf cannot be used") < page.index("t.csv is a table")
