"""The command line as a user runs it: in this process, or the service as one of its own."""

import json
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from service.cli import main
from tests.builders import Document, accelerometer_block
from tests.patience import LONG

COMMAND = Path(sys.executable).parent / "imu-health"
ROOT = Path(__file__).parents[3]
ENTRYPOINT = ROOT / "docker" / "entrypoint.sh"
READY = "imu-health is ready: open "


@dataclass(frozen=True)
class Ran:
    """Exit code and output of a command."""

    code: int
    out: str
    err: str

    @property
    def documents(self) -> list[Any]:
        """The JSON documents of standard output, one a line."""
        return [json.loads(line) for line in self.out.splitlines()]


Run = Callable[..., Ran]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Runs `imu-health` with arguments."""

    def run_command(*arguments: object) -> Ran:
        monkeypatch.setenv("LANGUAGE", "en")
        monkeypatch.setattr("sys.argv", ["imu-health", *map(str, arguments)])
        with pytest.raises(SystemExit) as left:
            main()
        written = capsys.readouterr()
        assert isinstance(left.value.code, int)
        return Ran(left.value.code, written.out, written.err)

    return run_command


def write(folder: Path, name: str, document: Document) -> Path:
    """A session file."""
    file = folder / name
    file.write_text(json.dumps(document), encoding="utf-8")
    return file


@pytest.fixture
def good_file(tmp_path: Path) -> Path:
    """A session that can be used."""
    return write(tmp_path, "good.json", accelerometer_block())


@pytest.fixture
def bad_file(tmp_path: Path) -> Path:
    """A session with three faults: NaN in row 3, α of 90°, a negative standard error in row 5."""
    document = accelerometer_block()
    document["table"]["A2"][2] = float("nan")
    document["stand"]["alpha_deg"] = 90.0
    document["table"]["A4_se"][4] = -1e-6
    return write(tmp_path, "bad.json", document)


@contextmanager
def started(*command: object, **environment: str) -> Iterator[str]:
    """The address that a starting service prints; the service is stopped as Ctrl-C stops it, and stops cleanly. It
    makes no diagnoses on its own, unless it is told to."""
    own = {"PATH": f"{COMMAND.parent}:/usr/bin:/bin", "PYTHONPATH": str(ROOT), "IMU_HEALTH_DIAGNOSIS_WORKERS": "0"}
    with subprocess.Popen(
        list(map(str, command)), stdout=subprocess.PIPE, text=True, env={**own, **environment}
    ) as process:
        try:
            assert process.stdout is not None
            line = process.stdout.readline().strip()
            assert line.startswith(READY), line
            yield line.removeprefix(READY)
        finally:
            process.send_signal(signal.SIGINT)
            process.wait(timeout=LONG)
