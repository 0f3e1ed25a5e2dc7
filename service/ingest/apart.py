"""Files read by a process of their own, with limits of memory and time: no file can end, freeze or bloat this one.

One process per program, started when it is first needed, has the readers loaded and does nothing but fork
(`service.ingest.fork_server`). Each file gets a fork, which takes the bytes through a socket and gives back plain
arrays: see `service.ingest.exchange`.
"""

import atexit
import json
import os
import socket
import struct
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import asdict, replace
from pathlib import Path
from threading import Condition, Lock, local
from time import monotonic
from typing import Any

from estimator.codec import KEPT
from estimator.errors import FormatError, Problem, ScheduleError, SessionError
from estimator.message import say
from service.errors import BusyError
from service.ingest.exchange import DAMAGED, Array, plain_bytes, unpack
from service.kit import limits
from service.kit.limits import Limits, refusal

SENDER: ContextVar[str] = ContextVar("sender", default="")
"""Of the request at hand; empty beside the requests, where files wait in a queue of their own."""

PAUSE = 1.0
"""Seconds between two words of it: a page looks again every two."""

Heard = Callable[[int, int], None]
"""Is told how many bytes were read of the file, after how many times through all of it; ends the reading by raising."""

_listener: ContextVar[Heard | None] = ContextVar("listener", default=None)


@contextmanager
def heard_by(listener: Heard) -> Iterator[None]:
    """Around the reading of a file: who hears how far it is."""
    token = _listener.set(listener)
    try:
        yield
    finally:
        _listener.reset(token)


def listener() -> Heard | None:
    """Who hears it."""
    return _listener.get()


class Teller:
    """Of the process that reads; parts may be read in a thread of their own."""

    def __init__(self, tell: Heard | None = None) -> None:
        self._tell, self._lock = tell, Lock()
        self._times, self._last = 0, 0.0

    def at(self, done: int, total: int) -> None:
        """So many bytes of all are read this time."""
        if self._tell is None:
            return
        with self._lock:
            now = monotonic()
            if self._tell is not None and now - self._last >= PAUSE:
                self._last = now
                self._tell(done, self._times)
            self._times += done >= total

    def silence(self) -> None:
        """The answer follows: nothing is told any more."""
        with self._lock:
            self._tell = None


class _InForce:
    """The one of this process."""

    teller = Teller()


def teller() -> Teller:
    """Of this process."""
    return _InForce.teller


def use(teller: Teller) -> None:
    """Sets it for this process."""
    _InForce.teller = teller


SERVER = "service.ingest.fork_server"
ROOT = str(Path(__file__).parents[2])
"""Where this package lies, so that the process finds the same."""
INHERITED = ("PATH", "LANG", "LC_ALL", "LD_LIBRARY_PATH", "TMPDIR", "OPENBLAS_NUM_THREADS")
"""Of the environment; the rest may hold secrets, which nothing that reads strangers' files needs."""
FRUGAL = {"POLARS_MAX_THREADS": "1", "MALLOC_ARENA_MAX": "1"}
"""One thread: more take address space, and several files are read at once already."""
WAITING = 3
"""Times the computing time that reading may last: the machine may be busy with other things."""
SHORTEST = 5
"""Seconds of computing for the smallest file: the largest table that may be unpacked of it takes four."""
SLOWEST = 500_000
"""Bytes of a file for which it may compute a second more, up to the limit in force: a third of a workbook's pace."""
PACE = 20_000_000
"""Bytes of a file for which reading may take a second more: a fifth of what a CSV is read at."""
GRACE = 5.0
"""Seconds beyond that before the process is taken for lost, which ends itself at its time."""
PATIENCE = 10.0
"""Seconds that a file waits for its turn before its sender is asked to come again."""
MOST_WAITING = 8
"""Files that wait for their turn: each holds a thread that answers requests, of which there are 40."""
LONGEST_LINE = 16 * 1024 * 1024
"""Bytes of JSON that come back: names, texts and problems; 10,000 columns take a tenth of it."""
MOMENT = 0.3
"""Seconds within which a process that is ending has ended."""
SIZE = struct.Struct(">Q")
READY = b"r"
END = b"end"
"""The line after the last part of an answer that comes in parts."""
SCANNED = b"scanned "
"""Begins a line that says how far a file was read."""
FELL = (OSError, EOFError, *DAMAGED)
"""What a fork that ends before its answer is seen as."""


def read_apart(job: str, content: bytes | Path, filename: str) -> Any:
    """What the job makes of the content; a SessionError where it cannot be used, BusyError where it must wait."""
    most = limits_of_file(content)
    with turn(), _refused_if_it_fell(filename, most):
        return _asked_again_if_ended(job, content, filename, most)


def read_parts(job: str, path: Path, filename: str) -> Iterator[Any]:
    """The parts that the job makes of a file, one after another; its process waits until they are taken."""
    most = limits_of_file(path)
    with turn(), _refused_if_it_fell(filename, most), _server.fork() as child:
        child.settimeout(most.seconds * WAITING + GRACE)
        _ask(child, {"job": job, "filename": filename, "limits": asdict(most)}, path)
        while (line := _line(child)) != END:
            yield _answer(child, line, most)


def limits_of_file(content: bytes | Path) -> Limits:
    """Those in force, with less time for a small file and more for a long one."""
    most = limits.in_force()
    size = content.stat().st_size if isinstance(content, Path) else len(content)
    more = size // PACE if isinstance(content, Path) else 0
    return replace(most, seconds=min(most.seconds, SHORTEST + size // SLOWEST) + more)


@contextmanager
def _refused_if_it_fell(filename: str, most: Limits) -> Iterator[None]:
    """The file is refused whose process ended before its answer."""
    try:
        yield
    except FELL as error:
        if isinstance(error, SessionError):
            raise
        raise refusal(
            filename,
            say(
                "cannot be read with {memory} MiB of memory in {seconds} s: it is damaged, or expands too much; "
                "write it again, or average or split it",
                memory=most.memory // 1024**2,
                seconds=most.seconds,
            ),
        ) from error


@contextmanager
def turn() -> Iterator[None]:
    """One of the turns of reading apart, for all that is done with a file: what it holds may be large until then."""
    with _turns.taken(limits.in_force().at_once):
        yield


def _asked_again_if_ended(job: str, content: bytes | Path, filename: str, most: Limits) -> Any:
    """A file is not to blame where the process that forks was ended from outside: it is read once more."""
    try:
        return _asked(job, content, filename, most)
    except FELL as error:
        if isinstance(error, SessionError) or not _server.has_ended():
            raise
    return _asked(job, content, filename, most)


def _asked(job: str, content: bytes | Path, filename: str, most: Limits) -> Any:
    with _server.fork() as child:
        child.settimeout(most.seconds * WAITING + GRACE)
        hears = listener()
        _ask(child, {"job": job, "filename": filename, "limits": asdict(most), "tells": hears is not None}, content)
        return _answer(child, _answer_line(child, hears), most)


def _answer_line(child: socket.socket, hears: Heard | None) -> bytes:
    """The line of the answer; those before it say how far the file was read."""
    while (line := _line(child)).startswith(SCANNED):
        done, times = map(int, line.removeprefix(SCANNED).split())
        if hears is not None:
            hears(done, times)
    return line


def _answer(child: socket.socket, line: bytes, most: Limits) -> Any:
    if line.startswith(b'{"refused"'):
        raise _refused(json.loads(line)["refused"])
    return unpack(line, most.memory, lambda array: _fill(child, array))


def _ask(child: socket.socket, request: dict[str, Any], content: bytes | Path) -> None:
    """Bytes go with it; a file is opened there."""
    if isinstance(content, Path):
        _send(child, json.dumps(request | {"path": str(content.absolute())}).encode())
    else:
        _send(child, json.dumps(request | {"size": len(content)}).encode())
        child.sendall(content)


def _refused(found: dict[str, Any]) -> FormatError | ScheduleError:
    kind = ScheduleError if found["schedule"] else FormatError
    return kind([KEPT.read(Problem, problem) for problem in found["problems"]], found["source"])


def _send(child: socket.socket, line: bytes) -> None:
    child.sendall(SIZE.pack(len(line)) + line)


def _line(child: socket.socket) -> bytes:
    (size,) = SIZE.unpack(_exactly(child, SIZE.size))
    if size > LONGEST_LINE:
        raise ValueError("a longer answer than agreed")
    return _exactly(child, size)


def _exactly(child: socket.socket, size: int) -> bytes:
    found = bytearray(size)
    _fill_view(child, memoryview(found))
    return bytes(found)


def _fill(child: socket.socket, array: Array) -> None:
    if array.size:
        _fill_view(child, plain_bytes(array))


def _fill_view(child: socket.socket, view: memoryview) -> None:
    while view:
        got = child.recv_into(view)
        if not got:
            raise EOFError("the process ended before its answer")
        view = view[got:]


class _Server:
    """The process that forks, started when it is first needed and again when it is gone."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._control: socket.socket | None = None
        self._owner = 0

    @contextmanager
    def fork(self) -> Iterator[socket.socket]:
        """A connection to a new process."""
        own, theirs = socket.socketpair()
        with own:
            with theirs, self._lock:
                try:
                    self._pass(theirs)
                except OSError:  # the process was ended from outside: once more with a new one
                    self.stop()
                    self._pass(theirs)
            yield own

    def _pass(self, connection: socket.socket) -> None:
        if self._control is None or self._owner != os.getpid():
            self._start()
        assert self._control is not None
        socket.send_fds(self._control, [READY], [connection.fileno()])

    def has_ended(self) -> bool:
        """Whether it was ended; the last moments of one that is ending are waited for."""
        if self._process is not None:
            try:
                self._process.wait(MOMENT)
            except subprocess.TimeoutExpired:
                return False
        return True

    def _start(self) -> None:
        """Its input is the connection; when that closes, because this process is gone, it ends."""
        self.stop()
        self._control, theirs = socket.socketpair()
        self._owner = os.getpid()
        environment = {name: os.environ[name] for name in INHERITED if name in os.environ}
        with theirs:
            self._process = subprocess.Popen(  # noqa: S603 - our own module, with nothing of a request
                [sys.executable, "-P", "-m", SERVER],
                stdin=theirs.fileno(),
                stdout=subprocess.DEVNULL,
                env=environment | FRUGAL | {"PYTHONPATH": ROOT},
            )
        if self._control.recv(1) != READY:
            raise RuntimeError("the process that reads files did not start; see its message above")

    def stop(self) -> None:
        """Ends it, as the end of this process does in any case."""
        if self._control is not None:
            self._control.close()
        if self._process is not None and self._owner == os.getpid():
            try:
                self._process.wait(GRACE)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self._process = self._control = None


class _Turns:
    """At most so many files at once, and of one sender one fewer; a few wait for a while, further ones are asked to
    come again."""

    def __init__(self) -> None:
        self._changed = Condition()
        self._busy: Counter[str] = Counter()
        self._waiting: Counter[str] = Counter()
        self._own = local()

    @contextmanager
    def taken(self, at_once: int) -> Iterator[None]:
        """A turn; a thread that has one needs no other."""
        if getattr(self._own, "held", False):
            yield
            return
        sender = SENDER.get()
        with self._changed:
            self._wait(sender, at_once)
            self._busy[sender] += 1
        self._own.held = True
        try:
            yield
        finally:
            self._own.held = False
            with self._changed:
                self._busy[sender] -= 1
                self._changed.notify_all()

    def _wait(self, sender: str, at_once: int) -> None:
        def is_free() -> bool:
            own = max(1, at_once - 1) if sender else at_once
            return self._busy.total() < at_once and self._busy[sender] < own

        if is_free():
            return
        own = MOST_WAITING // 2 if sender else MOST_WAITING
        if self._waiting.total() >= MOST_WAITING or self._waiting[sender] >= own:
            raise BusyError(BUSY)
        self._waiting[sender] += 1
        try:
            if not self._changed.wait_for(is_free, PATIENCE):
                raise BusyError(BUSY)
        finally:
            self._waiting[sender] -= 1


BUSY = "Many large files are being read; nothing of this one was stored. Send it again in a few seconds."
_server = _Server()
_turns = _Turns()
atexit.register(_server.stop)
