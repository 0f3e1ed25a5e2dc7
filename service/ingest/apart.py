"""Files read in a separate process, with limits of memory and time: no file can end, freeze or bloat this one.

One process per program, started on first use, has the readers loaded and only forks (`service.ingest.fork_server`).
Each file gets a fork, which receives the bytes through a socket and returns plain arrays: see
`service.ingest.exchange`.
"""

import atexit
import json
import os
import socket
import struct
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import asdict, replace
from pathlib import Path
from threading import Condition, Lock, local
from time import monotonic
from typing import Any

from estimator.codec import KEPT
from estimator.errors import FormatError, Problem, ScheduleError, SessionError
from estimator.json_object import Json
from service.errors import BusyError
from service.ingest.exchange import DAMAGED, Array, plain_bytes, unpack
from service.kit import limits
from service.kit.limits import Limits, refusal

SENDER: ContextVar[str] = ContextVar("sender", default="")
"""Sender of the current request; empty outside requests, where files wait in a queue of their own."""

PROGRESS_INTERVAL = 1.0
"""Seconds between two progress reports; a page polls every two."""

ProgressListener = Callable[[int, int], None]
"""Called with the bytes read in this pass and the number of passes finished; cancels the reading by raising."""

_progress_listener: ContextVar[ProgressListener | None] = ContextVar("listener", default=None)


@contextmanager
def reports_progress_to(new_listener: ProgressListener) -> Iterator[None]:
    """Reports the progress of reading a file to a listener."""
    token = _progress_listener.set(new_listener)
    try:
        yield
    finally:
        _progress_listener.reset(token)


def progress_listener() -> ProgressListener | None:
    """The listener of the current reading."""
    return _progress_listener.get()


class ProgressReporter:
    """Progress of the reading process; parts may be read in a thread of their own."""

    def __init__(self, progress_listener: ProgressListener | None = None) -> None:
        self._listener, self._lock = progress_listener, Lock()
        self._times, self._last = 0, 0.0

    def report(self, done: int, total: int) -> None:
        """Reports the bytes read in this pass."""
        if self._listener is None:
            return
        with self._lock:
            now = monotonic()
            if self._listener is not None and now - self._last >= PROGRESS_INTERVAL:
                self._last = now
                self._listener(done, self._times)
            self._times += done >= total

    def stop(self) -> None:
        """Ends the reports: the answer follows."""
        with self._lock:
            self._listener = None


class _Reporter:
    progress_reporter = ProgressReporter()


def progress_reporter() -> ProgressReporter:
    """The progress reporter of this process."""
    return _Reporter.progress_reporter


def use(reporter: ProgressReporter) -> None:
    """Sets the reporter of this process."""
    _Reporter.progress_reporter = reporter


SERVER = "service.ingest.fork_server"
ROOT = str(Path(__file__).parents[2])
"""Folder of this package, so that the process imports the same code."""
INHERITED = ("PATH", "LANG", "LC_ALL", "LD_LIBRARY_PATH", "TMPDIR", "OPENBLAS_NUM_THREADS")
"""Environment variables passed on; the rest may hold secrets, which a reader of uploaded files does not need."""
THREAD_LIMITS = {"POLARS_MAX_THREADS": "1", "MALLOC_ARENA_MAX": "1"}
"""One thread: more take address space, and several files are read at once already."""
WALL_CLOCK_FACTOR = 3
"""Wall-clock limit as a multiple of the limit of computing time: the machine may be busy."""
SHORTEST = 5
"""Seconds of computing allowed for the smallest file: the largest table that may be unpacked from it takes four."""
SLOWEST = 500_000
"""Bytes per extra second of computing, up to the limit in force: a third of the speed of reading a workbook."""
PACE = 5_000_000
"""Bytes per extra second of reading a file on disk: a third of the speed of the slowest text, with times of day."""
GRACE = 5.0
"""Seconds past its limit after which the process, which should have ended itself, is taken for lost."""
PATIENCE = 10.0
"""Seconds that a file waits for a reading slot before it is rejected with Retry-After."""
MOST_WAITING = 8
"""Files that may wait for a slot: each holds one of the 40 threads that answer requests."""
LONGEST_LINE = 16 * 1024 * 1024
"""Bytes of JSON in an answer: names, texts and problems; 10,000 columns take a tenth of it."""
ENDING_SECONDS = 0.3
"""Seconds within which an ending process has ended."""
SIZE = struct.Struct(">Q")
READY = b"r"
END = b"end"
"""Line after the last part of an answer in parts."""
SCANNED = b"scanned "
"""Prefix of a line of progress."""
PROCESS_ENDED = (OSError, EOFError, *DAMAGED)
"""Raised when a fork ends before its answer."""


def read_apart(job: str, content: bytes | Path, filename: str, mapping: Mapping[str, Any] | None = None) -> Any:
    """Result of the job on the content, under the mapping of a table of custom layout; SessionError for an unusable
    file, BusyError where it must wait."""
    most = limits_of_file(content)
    with turn(), _refused_if_process_ended(filename, most):
        return _read_again_if_server_ended({"job": job, "filename": filename, "mapping": mapping}, content, most)


def read_parts(job: str, path: Path, filename: str) -> Iterator[Any]:
    """The parts that the job makes of a file, one after another; its process waits until they are taken."""
    most = limits_of_file(path)
    with turn(), _refused_if_process_ended(filename, most), _server.fork() as child:
        child.settimeout(most.seconds * WALL_CLOCK_FACTOR + GRACE)
        _ask(child, {"job": job, "filename": filename, "limits": asdict(most)}, path)
        while (line := _line(child)) != END:
            yield _answer(child, line, most)


def limits_of_file(content: bytes | Path) -> Limits:
    """The limits in force, with less time for a small file and more for a long one."""
    most = limits.in_force()
    size = content.stat().st_size if isinstance(content, Path) else len(content)
    more = size // PACE if isinstance(content, Path) else 0
    return replace(most, seconds=min(most.seconds, SHORTEST + size // SLOWEST) + more)


@contextmanager
def _refused_if_process_ended(filename: str, most: Limits) -> Iterator[None]:
    """Refuses the file whose process ended before its answer."""
    try:
        yield
    except PROCESS_ENDED as error:
        if isinstance(error, SessionError):
            raise
        raise refusal(
            filename,
            "cannot be read with {memory} MiB of memory in {seconds} s: it is damaged, or expands too much; "
            "write it again, or average or split it",
            memory=most.memory // 1024**2,
            seconds=most.seconds,
        ) from error


@contextmanager
def turn() -> Iterator[None]:
    """Holds a slot for reading in a separate process until all work on the file is done: its contents may be large."""
    with _slots.taken(limits.in_force().at_once):
        yield


def _read_again_if_server_ended(request: Json, content: bytes | Path, limit: Limits) -> Any:
    """Reads once more where the fork server itself was ended from outside: the file is not to blame."""
    try:
        return _read(request, content, limit)
    except PROCESS_ENDED as error:
        if isinstance(error, SessionError) or not _server.has_ended():
            raise
    return _read(request, content, limit)


def _read(request: Json, content: bytes | Path, most: Limits) -> Any:
    with _server.fork() as child:
        child.settimeout(most.seconds * WALL_CLOCK_FACTOR + GRACE)
        listener = progress_listener()
        _ask(child, request | {"limits": asdict(most), "reports_progress": listener is not None}, content)
        return _answer(child, _answer_line(child, listener), most)


def _answer_line(child: socket.socket, progress_listener: ProgressListener | None) -> bytes:
    """The line of the answer; lines of progress before it go to the listener."""
    while (line := _line(child)).startswith(SCANNED):
        done, times = map(int, line.removeprefix(SCANNED).split())
        if progress_listener is not None:
            progress_listener(done, times)
    return line


def _answer(child: socket.socket, line: bytes, most: Limits) -> Any:
    if line.startswith(b'{"refused"'):
        raise _refused(json.loads(line)["refused"])
    return unpack(line, most.memory, lambda array: _fill(child, array))


def _ask(child: socket.socket, request: Json, content: bytes | Path) -> None:
    """Bytes are sent along; a file is opened by the other process."""
    if isinstance(content, Path):
        _send(child, json.dumps(request | {"path": str(content.absolute())}).encode())
    else:
        _send(child, json.dumps(request | {"size": len(content)}).encode())
        child.sendall(content)


def _refused(document: Json) -> FormatError | ScheduleError:
    kind = ScheduleError if document["schedule"] else FormatError
    return kind([KEPT.read(Problem, problem) for problem in document["problems"]], document["source"])


def _send(child: socket.socket, line: bytes) -> None:
    child.sendall(SIZE.pack(len(line)) + line)


def _line(child: socket.socket) -> bytes:
    (size,) = SIZE.unpack(_exactly(child, SIZE.size))
    if size > LONGEST_LINE:
        raise ValueError("a longer answer than agreed")
    return _exactly(child, size)


def _exactly(child: socket.socket, size: int) -> bytes:
    buffer = bytearray(size)
    _fill_view(child, memoryview(buffer))
    return bytes(buffer)


def _fill(child: socket.socket, array: Array) -> None:
    if array.size:
        _fill_view(child, plain_bytes(array))


def _fill_view(child: socket.socket, view: memoryview) -> None:
    while view:
        count = child.recv_into(view)
        if not count:
            raise EOFError("the process ended before its answer")
        view = view[count:]


class _ForkServer:
    """The fork server, started on first use and again when it is gone."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._control: socket.socket | None = None
        self._localer = 0

    @contextmanager
    def fork(self) -> Iterator[socket.socket]:
        """A connection to a new process."""
        ours, theirs = socket.socketpair()
        with ours:
            with theirs, self._lock:
                try:
                    self._pass(theirs)
                except OSError:  # the process was ended from outside: once more with a new one
                    self.stop()
                    self._pass(theirs)
            yield ours

    def _pass(self, connection: socket.socket) -> None:
        if self._control is None or self._localer != os.getpid():
            self._start()
        assert self._control is not None
        socket.send_fds(self._control, [READY], [connection.fileno()])

    def has_ended(self) -> bool:
        """Whether it has ended; waits a moment for one that is ending."""
        if self._process is not None:
            try:
                self._process.wait(ENDING_SECONDS)
            except subprocess.TimeoutExpired:
                return False
        return True

    def _start(self) -> None:
        """Starts the process. Its standard input is the connection; it ends when that closes with this process."""
        self.stop()
        self._control, theirs = socket.socketpair()
        self._localer = os.getpid()
        environment = {name: os.environ[name] for name in INHERITED if name in os.environ}
        with theirs:
            self._process = subprocess.Popen(  # noqa: S603 - our own module, with nothing of a request
                [sys.executable, "-P", "-m", SERVER],
                stdin=theirs.fileno(),
                stdout=subprocess.DEVNULL,
                env=environment | THREAD_LIMITS | {"PYTHONPATH": ROOT},
            )
        if self._control.recv(1) != READY:
            raise RuntimeError("the process that reads files did not start; see its message above")

    def stop(self) -> None:
        """Ends it, as the end of this process does in any case."""
        if self._control is not None:
            self._control.close()
        if self._process is not None and self._localer == os.getpid():
            try:
                self._process.wait(GRACE)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self._process = self._control = None


class _Slots:
    """Slots for reading files: one fewer for a single sender than in all. A few files wait for a while; further ones
    are rejected with Retry-After."""

    def __init__(self) -> None:
        self._changed = Condition()
        self._busy: Counter[str] = Counter()
        self._waiting: Counter[str] = Counter()
        self._local = local()

    @contextmanager
    def taken(self, at_once: int) -> Iterator[None]:
        """A slot; a thread that has one needs no other."""
        if getattr(self._local, "held", False):
            yield
            return
        sender = SENDER.get()
        with self._changed:
            self._wait(sender, at_once)
            self._busy[sender] += 1
        self._local.held = True
        try:
            yield
        finally:
            self._local.held = False
            with self._changed:
                self._busy[sender] -= 1
                self._changed.notify_all()

    def _wait(self, sender: str, at_once: int) -> None:
        def is_free() -> bool:
            sender_limit = max(1, at_once - 1) if sender else at_once
            return self._busy.total() < at_once and self._busy[sender] < sender_limit

        if is_free():
            return
        waiting_limit = MOST_WAITING // 2 if sender else MOST_WAITING
        if self._waiting.total() >= MOST_WAITING or self._waiting[sender] >= waiting_limit:
            raise BusyError(BUSY)
        self._waiting[sender] += 1
        try:
            if not self._changed.wait_for(is_free, PATIENCE):
                raise BusyError(BUSY)
        finally:
            self._waiting[sender] -= 1


BUSY = "Many large files are being read; nothing of this one was stored. Send it again in a few seconds."
_server = _ForkServer()
_slots = _Slots()
atexit.register(_server.stop)
