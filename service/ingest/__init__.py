"""Uploads of every accepted format → one checked session. The content decides what a file is, never its name.

Binary formats, and text that is long enough to take time or memory, are read by a process of their own: see `apart`.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from estimator.errors import SessionError
from estimator.json_object import Json
from estimator.on_demand import function_on_demand
from estimator.reading import read_session
from estimator.reading.source import LARGEST_FILE
from estimator.session import CalibrationSession
from service.ingest.formats import BINARY, is_binary
from service.kit.lock_order import outside_writing

if TYPE_CHECKING:
    from service.ingest.apart import read_apart, turn
    from service.kit.limits import in_force
else:
    read_apart = function_on_demand("service.ingest.apart", "read_apart")
    turn = function_on_demand("service.ingest.apart", "turn")
    in_force = function_on_demand("service.kit.limits", "in_force")

LONG = 1024 * 1024
"""Bytes of text that are read here: a tenth of a second at most, and 40 MB. A session of positions has a hundredth."""


@outside_writing
def read_upload(content: bytes | Path, filename: str) -> CalibrationSession:
    """The session that the content, or a file, holds; raises SessionError with every problem, named after the file.

    A raw log of more cells than may be held comes as its averaged positions.
    """
    if isinstance(content, Path) or _is_apart(content):
        return apart_session(content, filename)
    return read_session(content, name=filename, most=in_force().extent)


def read_first_rows(content: bytes | Path, filename: str) -> CalibrationSession:
    """The first rows of a session, which need not be enough for its programme; samples of a raw log as they are."""
    if isinstance(content, Path) or _is_apart(content):
        return apart_session(content, filename, "first-rows")
    return read_session(content, name=filename, most=in_force().extent, part=True)


@outside_writing
@contextmanager
def in_turn(content: bytes | Path) -> Iterator[None]:
    """Around all that is done with an upload: only so many that are read apart are held in memory at once."""
    if isinstance(content, Path) or _is_apart(content):
        with turn():
            yield
    else:
        yield


def _is_apart(content: bytes) -> bool:
    return is_binary(content) or len(content) > LONG


def apart_session(content: bytes | Path, filename: str, job: str = "session") -> CalibrationSession:
    """The same, by a process of its own."""
    session = read_apart(job, content, filename)
    assert isinstance(session, CalibrationSession)
    return session


def look_at(content: bytes | Path, filename: str) -> Json:
    """What a table of one's own layout looks like; ``session`` is true of a file that says itself what it is."""
    seen: Json = read_apart("look", content, filename)
    return seen


def is_own_layout(content: bytes | Path, filename: str) -> bool:
    """Whether a file is a table that does not say how it is to be read; what cannot be read is none."""
    start = content[:1024] if isinstance(content, bytes) else start_of(content, 1024)
    if start.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] in (b"{", b"[", b""):
        return False
    try:
        return not look_at(content, filename)["session"]
    except SessionError:
        return False


def start_of(path: Path, count: int) -> bytes:
    """The first bytes of a file."""
    with path.open("rb") as file:
        return file.read(count)


def read_file(path: Path, *, part: bool = False) -> CalibrationSession:
    """The same for a file on this machine, where the metadata of a CSV table may stand in a JSON file beside it;
    ``part``: its first rows, which need not be enough for its programme."""
    with path.open("rb") as file:
        start = file.read(max(map(len, BINARY)))
    is_long = path.stat().st_size > LARGEST_FILE
    if is_binary(start) or is_long:
        return apart_session(path, str(path), "first-rows" if part else "session")
    return read_session(path, part=part)
