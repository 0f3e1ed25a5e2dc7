"""A real receiver of webhooks on this machine, which answers as it is told and keeps what it got."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Condition, Event, Thread

from tests.patience import LONG


@dataclass(frozen=True)
class Message:
    """One request."""

    path: str
    headers: dict[str, str]
    body: bytes


@dataclass
class Receiver:
    """Answers with the statuses in turn, and with 204 after the last."""

    host: str
    statuses: list[int] = field(default_factory=list)
    messages: list[Message] = field(default_factory=list)
    held: Event | None = None
    """Event that holds all answers until it is set."""
    _came: Condition = field(default_factory=Condition)

    @property
    def url(self) -> str:
        """Address that it listens on."""
        return f"http://{self.host}/hook"

    def wait_for(self, count: int) -> list[Message]:
        """Waits for so many messages, and returns them."""
        with self._came:
            enough = self._came.wait_for(lambda: len(self.messages) >= count, LONG)
        assert enough, f"{len(self.messages)} of {count} messages came"
        return self.messages

    def keep(self, message: Message) -> None:
        """Takes one more."""
        with self._came:
            self.messages.append(message)
            self._came.notify_all()


@contextmanager
def receiver() -> Iterator[Receiver]:
    """A receiver that listens until the block ends."""

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["Content-Length"]))
            found.keep(Message(self.path, dict(self.headers), body))
            if found.held is not None:
                found.held.wait(60.0)
            status = found.statuses.pop(0) if found.statuses else 204
            self.send_response(status)
            if 300 <= status < 400:
                self.send_header("Location", f"http://{found.host}/elsewhere")
            self.send_header("Content-Length", "0")
            self.end_headers()

        def log_message(self, format: str, *args: object) -> None:
            """Quiet."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    found = Receiver(f"127.0.0.1:{server.server_port}")
    thread = Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield found
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
