"""Uploads of every accepted format → one checked session. The content decides what a file is, never its name.

Binary formats, and text long enough to take time or memory, are read in a separate process: see `apart`.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from estimator.errors import Problem, SessionError
from estimator.json_object import Json
from estimator.on_demand import function_on_demand
from estimator.reading import read_session
from estimator.reading.source import LARGEST_FILE
from estimator.session import CalibrationSession
from service.ingest.foreign import require_table
from service.ingest.formats import BINARY, JSON, LOGS, is_binary, start_of
from service.kit.lock_order import outside_writing

if TYPE_CHECKING:
    from service.ingest.apart import read_apart, turn
    from service.kit.limits import in_force
else:
    read_apart = function_on_demand("service.ingest.apart", "read_apart")
    turn = function_on_demand("service.ingest.apart", "turn")
    in_force = function_on_demand("service.kit.limits", "in_force")

LONG = 1024 * 1024
"""Bytes of text above which a file is read in a separate process; below, it takes at most 0.1 s and 40 MB here."""


@outside_writing
def read_upload(content: bytes | Path, filename: str, mapping: Mapping[str, Any] | None = None) -> CalibrationSession:
    """The session in the content or file, under the mapping of a table of custom layout; SessionError with every
    problem under the file's name.

    A raw log with more cells than the limit is returned as its averaged positions.
    """
    require_table(content, filename)
    if mapping is not None or isinstance(content, Path) or _is_apart(content):
        return apart_session(content, filename, "session", mapping)
    return read_session(content, name=filename, most=in_force().extent)


def read_first_rows(
    content: bytes | Path, filename: str, mapping: Mapping[str, Any] | None = None
) -> CalibrationSession:
    """The first rows of a session, which need not be enough for its programme; samples of a raw log as they are."""
    require_table(content, filename)
    if mapping is not None or isinstance(content, Path) or _is_apart(content):
        return apart_session(content, filename, "first-rows", mapping)
    return read_session(content, name=filename, most=in_force().extent, part=True)


@outside_writing
@contextmanager
def in_turn(content: bytes | Path) -> Iterator[None]:
    """Holds a reading slot while an upload is processed: the number of large files in memory is limited."""
    if isinstance(content, Path) or _is_apart(content):
        with turn():
            yield
    else:
        yield


def _is_apart(content: bytes) -> bool:
    return is_binary(content) or len(content) > LONG


def apart_session(
    content: bytes | Path, filename: str, job: str = "session", mapping: Mapping[str, Any] | None = None
) -> CalibrationSession:
    """The session, read in a separate process."""
    session = read_apart(job, content, filename, mapping)
    assert isinstance(session, CalibrationSession)
    return session


def look_at(content: bytes | Path, filename: str, mapping: Mapping[str, Any] | None = None) -> Json:
    """Preview of a table of custom layout; ``session`` is true where the file is a session file. Of a long text only
    its beginning and some later rows are read."""
    require_table(content, filename)
    preview: Json = read_apart("look", content, filename, mapping)
    return preview


def lines_of(content: bytes | Path, filename: str, mapping: Mapping[str, Any] | None = None) -> Json:
    """The answer of `look_at`, without columns, for a text that cannot be cut as it is understood; SessionError for any
    other file."""
    preview: Json = read_apart("lines", content, filename, mapping)
    return preview


def is_own_layout(content: bytes | Path, filename: str) -> bool:
    """Whether a file is a table without a session's metadata, or a text that may be cut to one by hand."""
    try:
        return _claims_nothing(content) and not look_at(content, filename)["session"]
    except SessionError:
        return _may_be_cut(content, filename)


def _may_be_cut(content: bytes | Path, filename: str) -> bool:
    try:
        require_table(content, filename)
        return not lines_of(content, filename)["session"]
    except SessionError:
        return False


OWN_LAYOUT = (
    "is a table of your own layout: choose it on the upload page, which asks what its columns are, or send a mapping "
    "with it (imu-health upload --mapping FILE)"
)


def said_as_table(content: bytes | Path, filename: str, problems: tuple[Problem, ...]) -> tuple[Problem, ...]:
    """The problems of a file that cannot be read at all, said of the table that it rather is; of a log or a damaged
    binary file its reader knows best."""
    start = start_of(content, 1024)
    if any(problem.field != "file" for problem in problems) or start.startswith(LOGS) or not _claims_nothing(content):
        return problems
    try:
        return problems if look_at(content, filename)["session"] else (Problem("file", OWN_LAYOUT),)
    except SessionError as fault:
        return problems if is_binary(start) else fault.problems


def _claims_nothing(content: bytes | Path) -> bool:
    """Whether a file neither is empty nor begins as a session file in JSON or CSV does."""
    start = start_of(content, 1024).lstrip(b"\xef\xbb\xbf \t\r\n#")
    return bool(start) and JSON.match(start) is None


def read_file(path: Path, *, part: bool = False) -> CalibrationSession:
    """The session of a local file; the metadata of a CSV table may stand in a JSON file next to it. ``part``: only its
    first rows, which need not be enough for its programme."""
    require_table(path, str(path))
    head = start_of(path, max(map(len, BINARY)))
    is_long = path.stat().st_size > LARGEST_FILE
    if is_binary(head) or is_long:
        return apart_session(path, str(path), "first-rows" if part else "session")
    return read_session(path, part=part)
