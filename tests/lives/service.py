"""The process: `imu-health serve` on a database and a data folder of its own, started, stopped and killed."""

import multiprocessing
import os
import signal
import sys
from dataclasses import dataclass, field
from multiprocessing.process import BaseProcess
from pathlib import Path
from types import ModuleType

import psutil

from service.cli import main
from service.kit.lock_order import WATCHED
from tests.patience import until

READY = "imu-health is ready: open "
forking = multiprocessing.get_context("forkserver")
forking.set_forkserver_preload(["service.cli", "service.commands.serve", "service.commands.database"])
"""Every start would load the program anew otherwise, a second and more of work."""
QUIET = {
    WATCHED: "yes",
    "OPENBLAS_NUM_THREADS": "1",
    "IMU_HEALTH_DIAGNOSIS_WORKERS": "1",
}


def run_command(arguments: tuple[str, ...], output: Path, environment: dict[str, str]) -> None:
    """Runs the command line in a process of its own, with all its output in a file."""
    written = os.open(output, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    os.dup2(written, 1)
    os.dup2(written, 2)
    os.environ.update(environment | {"LANGUAGE": "en"})
    sys.modules["__main__"] = ModuleType("__main__")  # what it starts itself is not to begin with the tests
    sys.argv = ["imu-health", *arguments]
    main()


@dataclass
class Service:
    """One service and where it keeps things; running or not."""

    database: str
    folder: Path
    hooks: tuple[str, ...] = ()
    """Hosts that it may call."""
    starts: int = 0
    processor: float = 0.0
    """Seconds that its processes have computed so far, those of it that ended included."""
    _process: BaseProcess | None = None
    _tree: dict[int, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.folder.mkdir(parents=True, exist_ok=True)

    @property
    def where(self) -> tuple[str, ...]:
        """The options that say which service is meant."""
        return ("--database-url", self.database, "--data-folder", str(self.folder / "data"))

    @property
    def environment(self) -> dict[str, str]:
        """Environment variables of the service: `QUIET` and its webhook hosts."""
        return QUIET | {"IMU_HEALTH_WEBHOOK_HOSTS": ",".join(self.hooks)}

    @property
    def log(self) -> Path:
        """File of the output since its last start."""
        return self.folder / f"service-{self.starts}.log"

    def command(self, *arguments: str) -> tuple[int, str]:
        """Runs a command to its end: its exit code, and what it printed."""
        output = self.folder / "command.txt"
        output.unlink(missing_ok=True)
        process = forking.Process(target=run_command, args=(arguments, output, self.environment))
        process.start()
        process.join()
        return process.exitcode or 0, output.read_text("utf-8", errors="replace")

    def start(self) -> str:
        """Starts it; its address once it is ready."""
        self.starts += 1
        arguments = ("serve", "--port", "0", *self.where)
        self._process = forking.Process(target=run_command, args=(arguments, self.log, self.environment))
        self._process.start()
        until(lambda: READY in self._written() or not self._is_alive())
        lines = [line for line in self._written().splitlines() if line.startswith(READY)]
        assert lines, f"the service did not start:\n{self._written()}"
        return lines[0].removeprefix(READY).strip()

    def stop(self, how: signal.Signals = signal.SIGTERM) -> None:
        """Ends it, with all processes that it started gone."""
        if self._process is None or self._process.pid is None:
            return
        self.count_processor()
        if self._is_alive():
            children = psutil.Process(self._process.pid).children(recursive=True)
            os.kill(self._process.pid, how)
            self._process.join()
            psutil.wait_procs(children)
        self._process = None
        self._tree.clear()

    def count_processor(self) -> float:
        """Seconds that its processes have computed until now."""
        for process in self._processes():
            try:
                times = process.cpu_times()
            except psutil.Error:
                continue
            spent = times.user + times.system
            self.processor += spent - self._tree.get(process.pid, 0.0)
            self._tree[process.pid] = spent
        return self.processor

    def _processes(self) -> list[psutil.Process]:
        if self._process is None or self._process.pid is None or not self._is_alive():
            return []
        head = psutil.Process(self._process.pid)
        return [head, *head.children(recursive=True)]

    def _is_alive(self) -> bool:
        return self._process is not None and self._process.is_alive()

    def _written(self) -> str:
        return self.log.read_text("utf-8", errors="replace") if self.log.exists() else ""
