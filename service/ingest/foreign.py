"""Files that are no table at all, by their first bytes: each is called by its name, with what to send instead."""

from collections.abc import Iterable
from pathlib import Path

from estimator.errors import FormatError, Problem
from service.ingest.formats import is_binary, start_of

START = 256
"""Bytes from which the kind of file is recognised."""
JPEG = "is a picture (JPEG); type or export its readings into a table and upload that as XLSX or CSV"
PNG = "is a picture (PNG); type or export its readings into a table and upload that as XLSX or CSV"
OTHER_PICTURE = "is a picture; type or export its readings into a table and upload that as XLSX or CSV"
PDF = "is a PDF document; export its table from where it was made and upload that as XLSX or CSV"
HTML = "is a web page (HTML); save its table as XLSX or CSV and upload that"
RTF = "is a text document (RTF); copy its table into a spreadsheet and upload that as XLSX or CSV"
OLD_OFFICE = "is a file of Excel or Word 97–2003 (XLS, DOC); save the table as XLSX or CSV and upload that"
DOCX = "is a Word document (DOCX); copy its table into a spreadsheet and upload that as XLSX or CSV"
ODF = "is an OpenDocument file (ODS, ODT); save the table as XLSX or CSV and upload that"
XLSB = "is a binary workbook (XLSB); save it as XLSX and upload that"
ARCHIVE = "is a packed archive (ZIP, 7z, RAR, gzip …); unpack it and upload the files in it"
SLIDES = "is a presentation (PPTX); copy its table into a spreadsheet and upload that as XLSX or CSV"
KINDS = (
    (0, b"\xff\xd8\xff", JPEG), (0, b"\x89PNG\r\n", PNG), (0, b"GIF8", OTHER_PICTURE), (0, b"II*\0", OTHER_PICTURE),
    (0, b"MM\0*", OTHER_PICTURE), (8, b"WEBP", OTHER_PICTURE), (4, b"ftyphei", OTHER_PICTURE),
    (4, b"ftypmif1", OTHER_PICTURE), (0, b"%PDF-", PDF), (0, rb"{\rtf", RTF),
    (0, b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", OLD_OFFICE), (30, b"mimetypeapplication/vnd.oasis.opendocument", ODF),
    (0, b"\x1f\x8b\x08", ARCHIVE), (0, b"7z\xbc\xaf\x27\x1c", ARCHIVE), (0, b"Rar!\x1a\x07", ARCHIVE),
    (0, b"\xfd7zXZ\0", ARCHIVE), (0, b"\x28\xb5\x2f\xfd", ARCHIVE), (0, b"BZh", ARCHIVE),
)  # fmt: skip
"""Place of the first byte, the bytes, and the refusal."""
WEB_PAGE = (b"<!doctype html", b"<html")
MEMBERS = (("word/", DOCX), ("ppt/", SLIDES), ("xl/workbook.bin", XLSB))
"""Refusals of archives, by the beginning of a member's name."""


def require_table(content: bytes | Path, filename: str) -> None:
    """Raises FormatError for a file that can hold no table, such as a picture."""
    start = start_of(content, START)
    is_ours = is_binary(start)
    for place, magic, said in KINDS:
        if start.startswith(magic, place) and not (is_ours and place == 0):
            raise _refusal(filename, said)
    if start.lstrip(b"\xef\xbb\xbf \t\r\n").lower().startswith(WEB_PAGE):
        raise _refusal(filename, HTML)


def require_workbook(members: Iterable[str], filename: str) -> None:
    """Refuses an archive that is no workbook, by the names of its members."""
    names = tuple(members)
    for beginning, said in MEMBERS:
        if any(name.startswith(beginning) for name in names):
            raise _refusal(filename, said)
    if not any(name.startswith("xl/") for name in names):
        raise _refusal(filename, ARCHIVE)


def _refusal(filename: str, said: str) -> FormatError:
    return FormatError([Problem("file", said)], filename)
