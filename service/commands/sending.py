"""A session file on its way to the service; a large one is sent as it is read, and followed until it is stored."""

from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from rich.progress import DownloadColumn

from estimator.errors import Problem
from service.client import Client
from service.commands.console import are_large
from service.commands.following import Moved, bar, followed
from service.errors import RefusedError, ServiceError
from service.jobs.records import JobState


@dataclass(frozen=True)
class Sending:
    """How files are sent."""

    client: Client
    stated: dict[str, str]
    """What is said of each."""
    wait: bool
    quiet: bool

    def sent(self, file: Path) -> dict[str, Any]:
        """The receipt; of a large file that nobody waits for its job. RefusedError where it cannot be used."""
        if not are_large((file,)):
            return self.client.send(file.name, file.read_bytes(), self.stated)
        size, counts = file.stat().st_size, DownloadColumn()
        with file.open("rb") as content, bar(file.name, quiet=self.quiet, counts=counts) as moved:
            watched: Any = _Watched(content, size, f"sending {file.name}", moved)
            answer = self.client.send(file.name, watched, self.stated, later=True)
        if "verdict" in answer or not self.wait:
            return answer
        return self._became(followed(self.client, answer["id"], quiet=self.quiet))

    def _became(self, job: dict[str, Any]) -> dict[str, Any]:
        """The receipt of the session that a file became."""
        if job["problems"]:
            found = tuple(Problem(one["field"], one["message"], one["row"]) for one in job["problems"])
            raise RefusedError(f"{job['subject']} cannot be used.", found)
        if job["state"] != JobState.DONE:
            reasons = " ".join(one["reason"] for one in job["failures"])
            raise ServiceError(f"Job {job['id']} is {job['state']}. {reasons}".strip())
        receipt: dict[str, Any] = self.client.get(f"/uploads/{job['upload']}").json()["session"]
        return receipt | {"created": True, "url": f"{self.client.server}/api/v1/sessions/{receipt['id']}"}


@dataclass(frozen=True)
class _Watched:
    """A file that says how much of it was taken."""

    file: IO[bytes]
    size: int
    doing: str
    moved: Moved

    def read(self, size: int = -1) -> bytes:
        """The next part."""
        part = self.file.read(size)
        self.moved(self.file.tell(), self.size, self.doing)
        return part

    def fileno(self) -> int:
        """By which its length is told."""
        return self.file.fileno()

    def seek(self, place: int) -> int:
        """To its beginning, where it is sent."""
        return self.file.seek(place)
