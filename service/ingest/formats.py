"""The binary formats by their first bytes. The content decides what a file is, never its name."""

PARQUET = b"PAR1"
"""Apache Parquet file format."""
XLSX = b"PK\x03\x04"
"""Of a ZIP archive (APPNOTE 4.3.7), which a workbook is."""
HDF5 = b"\x89HDF\r\n\x1a\n"
"""HDF5 file format, III.A."""
MAT = b"MATLAB "
"""Of every MAT file."""
BINARY = (PARQUET, XLSX, HDF5, MAT)
"""All."""


def is_binary(start: bytes) -> bool:
    """Whether the first bytes are those of a binary format."""
    return start.startswith(BINARY)


def may_be_log(start: bytes) -> bool:
    """Whether the first bytes are those of a format that can be scanned: Parquet, or CSV with its metadata."""
    return start.startswith(PARQUET) or start.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"#")
