"""The power is cut at every moment of an upload: what was acknowledged is there, anything else wholly or not at all,
and sent again it is stored once."""

import shutil
import subprocess
import sys
from copy import deepcopy
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import pytest

from service.opening import open_database
from service.settings import Settings
from service.storage import Files, Storage
from service.storage.schema import upgrade
from service.storage.waiting import FOLDER as WAITING
from tests.service.made_sessions import session_bytes
from tests.service.storage.disk import TRACED, Call, Disk, Left, calls, moments
from tests.service.storage.intact import SENSORS, faults
from tests.service.storage.sending import WAYS, go_on

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
SESSION = session_bytes(m=SENSORS)
UPLOAD = """
import os, sys
from datetime import UTC, datetime
from pathlib import Path
from service.opening import open_database
from service.settings import Settings
from service.storage import Files, Storage
from tests.service.storage.sending import WAYS, go_on
content = sys.stdin.buffer.read()
for name, way in WAYS.items():
    settings = Settings(data_folder=Path(sys.argv[1]) / name)
    storage = Storage(open_database(settings.database), Files(settings.files))
    way(storage, content, datetime.now(UTC))
    os.write(1, name.encode())
    go_on(storage, datetime.now(UTC))
os._exit(0)
"""


@dataclass(frozen=True)
class Recorded:
    """An upload in one of the ways."""

    way: str
    before: Disk
    calls: list[Call]

    @property
    def answered(self) -> int:
        """Number of calls after which it is acknowledged."""
        return next(n for n, call in enumerate(self.calls, 1) if call.data == self.way.encode())


@pytest.fixture(scope="module")
def every(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Recorded]:
    """The disk before an upload and the calls of the upload, by way: one process does all of them."""
    if shutil.which("strace") is None:
        pytest.skip("strace is not installed: the calls of an upload cannot be recorded")
    folder = tmp_path_factory.mktemp("power")
    for way in WAYS:
        upgrade(Settings(data_folder=folder / way).database)
    before, trace = {way: Disk.of(folder / way) for way in WAYS}, folder.with_name("trace")
    command = ["strace", "-f", "--seccomp-bpf", "-y", "-xx", "-s", "100000000", "-e", f"trace={TRACED}", "-o", trace]
    own = [sys.executable, "-c", UPLOAD, folder]
    done = subprocess.run([*command, *own], input=SESSION, capture_output=True, check=False)
    if b"ptrace" in done.stderr.lower():
        pytest.skip("strace may not look at processes here")
    assert done.stdout == "".join(WAYS).encode(), done.stderr
    text = trace.read_text()
    return {way: Recorded(way, before[way], list(calls(text, str(folder / way)))) for way in WAYS}


@pytest.fixture(params=[pytest.param(way, marks=[pytest.mark.slow] * (way == "landed")) for way in WAYS])
def recorded(request: pytest.FixtureRequest, every: dict[str, Recorded]) -> Recorded:
    """An upload in one of the ways."""
    return every[request.param]


def test_all_is_synced_before_the_answer_file_before_row(recorded: Recorded) -> None:
    calls_before = recorded.calls[: recorded.answered]
    synced = [Path(call.path) for call in calls_before if call.name in ("fsync", "fdatasync")]
    parts = [n for n, path in enumerate(synced) if path.name.startswith(".part-")]
    folders = [n for n, path in enumerate(synced) if path.name in ("files", WAITING)]
    rows = [n for n, path in enumerate(synced) if path.name.endswith("-wal")]
    assert parts[-1] < folders[-1] < rows[-1]


@pytest.mark.parametrize("names_kept", [False, True], ids=["nothing unsynced", "names but not bytes"])
def test_whenever_the_power_is_cut_nothing_acknowledged_is_lost(
    recorded: Recorded, tmp_path: Path, names_kept: bool
) -> None:
    done, end, seen = recorded.calls, recorded.answered, set[tuple[bool, Left]]()
    for number, disk in moments(deepcopy(recorded.before), done):
        left, place = disk.left(names_kept=names_kept), tmp_path / str(number)
        if (number >= end, left) in seen:
            continue
        seen.add((number >= end, left))
        place.mkdir()
        disk.write(left, place)
        settings = Settings(data_folder=place)
        database = open_database(settings.database)
        storage = Storage(database, Files(settings.files))
        go_on(storage, NOW)
        assert faults(settings, [SESSION] if number >= end else [], [SESSION]) == [], (number, done[number - 1])
        WAYS[recorded.way](storage, SESSION, NOW)
        go_on(storage, NOW)
        database.close()
        assert faults(settings, [SESSION], [SESSION]) == []
