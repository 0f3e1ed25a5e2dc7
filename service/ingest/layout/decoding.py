"""Bytes of text → text."""

from charset_normalizer import from_bytes

from service.kit.limits import refusal

MARKS = ((b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"))
"""Byte order marks."""
CODE_PAGES = ["cp1251", "cp1252", "koi8_r", "cp866"]
"""Code pages, distinguished by frequencies of letters."""
SAMPLE_BYTES = 64 * 1024
"""Bytes from which the encoding is detected: headings stand at the beginning."""
NO_TEXT = "is neither text nor in a known format; upload XLSX, CSV, JSON, Parquet, HDF5 or MAT"
UTF16_ZEROS = 0.2
"""Share of zero bytes at even or odd places from which text is UTF-16 without a mark."""


def decoded(content: bytes, filename: str, chosen: str | None = None) -> tuple[str, str]:
    """The text, and its encoding."""
    encoding = chosen or encoding_of(content)
    try:
        return content.decode(encoding).lstrip("\ufeff"), encoding.removesuffix("-sig")
    except (UnicodeDecodeError, LookupError) as error:
        if chosen is None:
            raise refusal(filename, NO_TEXT) from error
        raise refusal(filename, "is not {encoding} text; choose another encoding", encoding=encoding) from error


def encoding_of(content: bytes) -> str:
    """The encoding of a text by its bytes."""
    for mark, encoding in MARKS:
        if content.startswith(mark):
            return encoding
    start = content[:SAMPLE_BYTES]
    for place, encoding in ((1, "utf-16-le"), (0, "utf-16-be")):
        if start[place::2].count(0) > UTF16_ZEROS * len(start):
            return encoding
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        best = from_bytes(bytes(_non_ascii_lines(content)), cp_isolation=CODE_PAGES).best()
        return "cp1252" if best is None else best.encoding
    return "utf-8"


def _non_ascii_lines(content: bytes) -> bytes:
    """The lines with letters beyond ASCII: digits do not tell code pages apart."""
    lines = content[:SAMPLE_BYTES].splitlines()
    return b"\n".join(line for line in lines if any(byte > 127 for byte in line))
