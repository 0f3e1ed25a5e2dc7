"""The binary formats by their first bytes. The content decides what a file is, never its name."""

import re
from pathlib import Path

PARQUET = b"PAR1"
"""Apache Parquet file format."""
XLSX = b"PK\x03\x04"
"""First bytes of a ZIP archive (APPNOTE 4.3.7), which a workbook is."""
HDF5 = b"\x89HDF\r\n\x1a\n"
"""HDF5 file format, III.A."""
MAT = b"MATLAB "
"""First bytes of every MAT file."""
ULOG = b"ULog\x01\x125"
"""ULog file format, header."""
MCAP = b"\x89MCAP0\r\n"
"""MCAP format specification, magic."""
SQLITE = b"SQLite format 3\x00"
"""SQLite file format, 1.3.1; a rosbag2 may be one."""
LOGS = (ULOG, MCAP, SQLITE)
"""Logs of flight controllers and robots."""
BINARY = (PARQUET, XLSX, HDF5, MAT)
"""Session files and tables."""


def start_of(content: bytes | Path, count: int) -> bytes:
    """The first bytes of a content or file."""
    if isinstance(content, bytes):
        return content[:count]
    with content.open("rb") as file:
        return file.read(count)


def is_binary(start: bytes) -> bool:
    """Whether the first bytes are those of a binary format."""
    return start.startswith((*BINARY, *LOGS))


def may_be_log(start: bytes) -> bool:
    """Whether the first bytes are those of a format that can be scanned: Parquet, or CSV with its metadata."""
    return start.startswith(PARQUET) or start.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"#")


JSON = re.compile(rb"[\xef\xbb\xbf \t\r\n]*(?:\{|\[\s*[\[{\"\d\]-])")
"""Beginning of a text in JSON."""


def may_be_long(start: bytes) -> bool:
    """Whether the first bytes are those of a format that can be read in parts: Parquet, or rows of text."""
    return start.startswith(PARQUET) or not (is_binary(start) or JSON.match(start) or not start.strip())
