"""The process that has the readers loaded and forks for every file; `service.ingest.apart` starts it.

A fork limits itself before it sees a byte of the file: address space, computing time, and a wall-clock alarm, which the
kernel keeps whatever a library does. It starts in milliseconds, because everything is loaded already.
"""

import gc
import json
import os
import resource
import signal
import socket
import sys
from collections.abc import Iterator
from pathlib import Path

from estimator.codec import KEPT
from estimator.errors import ScheduleError, SessionError
from estimator.json_object import Json
from service.ingest import apart, jobs
from service.ingest.apart import END, READY, SCANNED, SIZE, WALL_CLOCK_FACTOR
from service.ingest.exchange import Packed, pack, plain_bytes
from service.kit import limits
from service.kit.limits import Limits, refusal

STATM = Path("/proc/self/statm")
"""Sizes of this process in pages, the total first (Linux)."""
MAPS = 4
"""Times that a file may be mapped: every open scan maps it."""
DATA = 5
"""Index there of the private writable pages."""
USUAL = 512 * 1024**2
"""Bytes of address space assumed for the readers where the platform does not tell."""
STDIN, STDERR = 0, 2
"""File descriptors: the connection to the parent program, and its messages."""


def main() -> None:
    """Forks for every connection that is passed in, until the parent program is gone."""
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for the forks: the kernel takes them away
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # of a terminal; the program that asks decides
    gc.collect()
    gc.freeze()
    with socket.socket(fileno=STDIN) as control:
        control.sendall(READY)
        while _served(control):
            pass


def _served(control: socket.socket) -> bool:
    message, descriptors, _, _ = socket.recv_fds(control, 1, 1)
    if not message:
        return False
    with socket.socket(fileno=descriptors[0]) as connection:
        if os.fork() == 0:
            _answer_and_end(control, connection)
    return True


def _answer_and_end(control: socket.socket, connection: socket.socket) -> None:
    """Answers in the fork and ends it; a fault of a reader ends it too, with a traceback."""
    control.close()
    _quieten_libraries()
    _answer(connection)
    connection.close()
    os._exit(0)


def _quieten_libraries() -> None:
    """Libraries print messages about a damaged file; tracebacks of our own are still written."""
    sys.stderr = os.fdopen(os.dup(STDERR), "w")
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), STDERR)


def _answer(connection: socket.socket) -> None:
    (size,) = SIZE.unpack(connection.recv(SIZE.size, socket.MSG_WAITALL))
    request = json.loads(connection.recv(size, socket.MSG_WAITALL))
    most = Limits(**request["limits"])
    limits.use(most)
    _limit_this_process(most, _mapped(request))
    if request.get("reports_progress"):
        apart.use(apart.ProgressReporter(lambda done, times: _report_progress(connection, done, times)))
    try:
        for packed in _read(connection, request):
            _send(connection, packed)
    except SessionError as error:
        _send(connection, Packed(_refusal(error), ()))
    except MemoryError:
        _send(connection, Packed(_refusal(_too_large(request["filename"], most)), ()))


def _read(connection: socket.socket, request: Json) -> Iterator[Packed]:
    """The answer, or its parts and their end."""
    content, filename = _content(connection, request), request["filename"]
    if request["job"] in jobs.PARTED and isinstance(content, Path):
        for part in jobs.PARTED[request["job"]](content, filename):
            yield pack(part)
        yield Packed(END, ())
    else:
        yield pack(jobs.JOBS[request["job"]](content, filename, request["mapping"]))


def _report_progress(connection: socket.socket, done: int, times: int) -> None:
    """Ends the process where nobody is connected any more."""
    line = SCANNED + f"{done} {times}".encode()
    try:
        connection.sendall(SIZE.pack(len(line)) + line)
    except OSError:
        os._exit(0)


def _send(connection: socket.socket, packed: Packed) -> None:
    apart.progress_reporter().stop()
    connection.sendall(SIZE.pack(len(packed.line)) + packed.line)
    for array in packed.arrays:
        connection.sendall(plain_bytes(array))


def _content(connection: socket.socket, request: Json) -> bytes | Path:
    if "path" in request:
        return Path(request["path"])
    return connection.recv(request["size"], socket.MSG_WAITALL) if request["size"] else b""


def _too_large(filename: str, most: Limits) -> SessionError:
    size = most.memory // 1024**2
    return refusal(filename, f"needs more than {size} MiB of memory to be read; average or split it")


def _refusal(error: SessionError) -> bytes:
    problems = KEPT.written(list(error.problems))
    schedule = isinstance(error, ScheduleError)
    return json.dumps({"refused": {"schedule": schedule, "problems": problems, "source": error.source}}).encode()


def _mapped(request: Json) -> int:
    """Bytes of a file that may be mapped: this takes address space, but memory that the kernel can take back."""
    return MAPS * Path(request["path"]).stat().st_size if "path" in request else 0


def _limit_this_process(most: Limits, mapped: int) -> None:
    """Limits that end it, without a core dump."""
    pages = _pages()
    space, data = pages[0] + most.memory + mapped, pages[DATA] + most.memory
    resource.setrlimit(resource.RLIMIT_AS, (space, space))
    resource.setrlimit(resource.RLIMIT_DATA, (data, data))
    resource.setrlimit(resource.RLIMIT_CPU, (most.seconds, most.seconds))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
    signal.setitimer(signal.ITIMER_REAL, most.seconds * WALL_CLOCK_FACTOR)


def _pages() -> list[int]:
    """Bytes that this process has before it reads anything, in the order of `STATM`."""
    try:
        return [int(pages) * resource.getpagesize() for pages in STATM.read_text().split()]
    except OSError:
        return [USUAL] * (DATA + 1)


if __name__ == "__main__":
    main()
