"""The process that has the readers loaded and forks for every file: see `service.ingest.apart`, which starts it.

A fork limits itself before it sees a byte of the file: address space, computing time, and an alarm for the time by the
clock, which the kernel keeps whatever a library does. It starts in milliseconds, because everything is loaded already.
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
from service.ingest import apart as scanned
from service.ingest import jobs
from service.ingest.apart import END, READY, SCANNED, SIZE, WAITING
from service.ingest.exchange import Packed, pack, plain_bytes
from service.kit import limits
from service.kit.limits import Limits, refusal

STATM = Path("/proc/self/statm")
"""Sizes of this process in pages, the whole first (Linux)."""
MAPS = 4
"""Times that a file may be mapped: every scan that is open maps it."""
DATA = 5
"""Place there of what is private and can be written."""
USUAL = 512 * 1024**2
"""Bytes of address space that the readers take where the platform does not say."""
STDIN, STDERR = 0, 2
"""File descriptors: of the way to the program that asks, and of its messages."""


def main() -> None:
    """Fork for every connection that is passed in, until the program that asks is gone."""
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for the forks: the kernel takes them away
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # of a terminal; the program that asks decides
    gc.collect()
    gc.freeze()
    with socket.socket(fileno=STDIN) as control:
        control.sendall(READY)
        while _served(control):
            pass


def _served(control: socket.socket) -> bool:
    message, handles, _, _ = socket.recv_fds(control, 1, 1)
    if not message:
        return False
    with socket.socket(fileno=handles[0]) as connection:
        if os.fork() == 0:
            _answer_and_end(control, connection)
    return True


def _answer_and_end(control: socket.socket, connection: socket.socket) -> None:
    """In the fork; a fault of a reader ends it too, with a traceback."""
    control.close()
    _quieten_libraries()
    _answer(connection)
    connection.close()
    os._exit(0)


def _quieten_libraries() -> None:
    """They print what they think of a damaged file; what Python says of a fault of ours is still written."""
    sys.stderr = os.fdopen(os.dup(STDERR), "w")
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), STDERR)


def _answer(connection: socket.socket) -> None:
    (size,) = SIZE.unpack(connection.recv(SIZE.size, socket.MSG_WAITALL))
    request = json.loads(connection.recv(size, socket.MSG_WAITALL))
    most = Limits(**request["limits"])
    limits.use(most)
    _limit_this_process(most, _mapped(request))
    if request.get("tells"):
        scanned.use(scanned.Teller(lambda done, times: _tell(connection, done, times)))
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
        yield pack(jobs.JOBS[request["job"]](content, filename))


def _tell(connection: socket.socket, done: int, times: int) -> None:
    """Nobody waits for the answer where nobody hears this."""
    line = SCANNED + f"{done} {times}".encode()
    try:
        connection.sendall(SIZE.pack(len(line)) + line)
    except OSError:
        os._exit(0)


def _send(connection: socket.socket, packed: Packed) -> None:
    scanned.teller().silence()
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
    found = KEPT.written(list(error.problems))
    schedule = isinstance(error, ScheduleError)
    return json.dumps({"refused": {"schedule": schedule, "problems": found, "source": error.source}}).encode()


def _mapped(request: Json) -> int:
    """Bytes of a file that may be mapped: that takes address space, and no memory that could not be taken back."""
    return MAPS * Path(request["path"]).stat().st_size if "path" in request else 0


def _limit_this_process(most: Limits, mapped: int) -> None:
    """Limits that end it, and no way to dump what it holds."""
    own = _pages()
    space, data = own[0] + most.memory + mapped, own[DATA] + most.memory
    resource.setrlimit(resource.RLIMIT_AS, (space, space))
    resource.setrlimit(resource.RLIMIT_DATA, (data, data))
    resource.setrlimit(resource.RLIMIT_CPU, (most.seconds, most.seconds))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
    signal.setitimer(signal.ITIMER_REAL, most.seconds * WAITING)


def _pages() -> list[int]:
    """Bytes that this process has before it reads anything: as `STATM` has them."""
    try:
        return [int(pages) * resource.getpagesize() for pages in STATM.read_text().split()]
    except OSError:
        return [USUAL] * (DATA + 1)


if __name__ == "__main__":
    main()
