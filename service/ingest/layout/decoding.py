"""Bytes of text → text, whatever wrote them: a byte order mark, UTF-8, or a Windows code page."""

from charset_normalizer import from_bytes

from estimator.message import say
from service.kit.limits import refusal

MARKS = ((b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"))
"""Byte order marks."""
ENCODINGS = ("utf-8", "utf-16", "utf-16-le", "utf-16-be", "cp1251", "cp1252", "koi8-r", "cp866")
"""That tables come in here, and that can be chosen by hand."""
CODE_PAGES = ["cp1251", "cp1252", "koi8_r", "cp866"]
"""That are told from each other by the letters they give."""
LOOKED_AT = 64 * 1024
"""Bytes that an encoding is told by: headings stand at the beginning."""
BARE_ZEROS = 0.2
"""Share of zero bytes in one half of the places from which text is UTF-16 without a mark."""


def decoded(content: bytes, filename: str, stated: str | None = None) -> tuple[str, str]:
    """The text, and how it was written."""
    encoding = stated or _encoding(content)
    try:
        return content.decode(encoding).lstrip("\ufeff"), encoding.removesuffix("-sig")
    except (UnicodeDecodeError, LookupError) as error:
        raise refusal(filename, say("is not {encoding} text; choose another encoding", encoding=encoding)) from error


def _encoding(content: bytes) -> str:
    for mark, encoding in MARKS:
        if content.startswith(mark):
            return encoding
    start = content[:LOOKED_AT]
    for place, encoding in ((1, "utf-16-le"), (0, "utf-16-be")):
        if start[place::2].count(0) > BARE_ZEROS * len(start):
            return encoding
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        best = from_bytes(bytes(_telling(content)), cp_isolation=CODE_PAGES).best()
        return "cp1252" if best is None else best.encoding
    return "utf-8"


def _telling(content: bytes) -> bytes:
    """The lines that have letters beyond ASCII: digits tell no code page from another."""
    lines = content[:LOOKED_AT].splitlines()
    return b"\n".join(line for line in lines if any(byte > 127 for byte in line))
