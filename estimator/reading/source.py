"""Sources of a session: a path, a dict, or bytes whose content tells JSON from CSV."""

from collections.abc import Mapping
from pathlib import Path

from estimator.reading.csv_text import ADVICE, SEPARATORS, parse_csv
from estimator.reading.json_text import parse_json
from estimator.reading.problems import Problems

LARGEST_FILE = 256 * 1024 * 1024
"""Bytes. Text of this size holds about ten million rows of one sensor; a longer log is averaged before."""


def display_name(source: object) -> str | None:
    """Name of a source in messages: its path; None for a dict or bytes."""
    return str(source)[:200] if isinstance(source, str | Path) else None


def load(source: object, problems: Problems) -> Mapping[str, object]:
    """The document that a source holds, as yet unchecked."""
    if isinstance(source, Mapping):
        return source
    if isinstance(source, bytes | bytearray):
        return _parse(_decode(bytes(source), problems), problems, None)
    if isinstance(source, str | Path):
        return _load_path(source, problems)
    raise problems.fail(
        "file", "a session is read from a path, a dict or bytes, not from {name}", name=type(source).__name__
    )


def _load_path(source: str | Path, problems: Problems) -> dict[str, object]:
    if isinstance(source, str) and source.lstrip()[:1] in ("{", "#"):
        raise problems.fail("file", "this is the text of a file, not its path; pass a path, a dict or bytes")
    path = Path(source)
    text = _decode(_read(path, problems), problems)
    companion = path.with_suffix(".json") if path.suffix.lower() == ".csv" else None
    sidecar = None
    if companion is not None and not text.lstrip().startswith("#") and _exists(companion):
        sidecar = _decode(_read(companion, problems), problems)
    return _parse(text, problems, sidecar)


def _parse(text: str, problems: Problems, sidecar: str | None) -> dict[str, object]:
    """Parses by content: JSON starts with a brace (or a bracket), CSV with # lines, or with a header and a sidecar."""
    start = text.lstrip()[:1]
    if not start:
        raise problems.fail("file", "is empty")
    if start in "{[":
        return parse_json(text, problems)
    if start == "#" or sidecar is not None:
        return parse_csv(text, problems, sidecar)
    first_line = text.lstrip().partition("\n")[0]
    if any(separator in first_line for separator in SEPARATORS):
        raise problems.fail("file", "is a CSV table without metadata; {advice}", advice=ADVICE)
    raise problems.fail("file", "is neither JSON (starting with a brace) nor CSV with metadata (starting with #)")


def _read(path: Path, problems: Problems) -> bytes:
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise problems.fail("file", "cannot be read: {reason}", reason=reason) from error
    return content


def _exists(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def _decode(content: bytes, problems: Problems) -> str:
    if len(content) > LARGEST_FILE:
        limit = LARGEST_FILE // 1024**2
        raise problems.fail("file", "is larger than {limit} MiB; average or split the log", limit=limit)
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise problems.fail("file", "is UTF-16 text; save it as UTF-8")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise problems.fail(
            "file", "is not UTF-8 text (byte {position}); save it as UTF-8", position=error.start + 1
        ) from error
