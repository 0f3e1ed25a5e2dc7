"""The test's record of its own actions, and its only channel to the service."""

import json
import signal
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import Any

import httpx

from tests.lives.service import Service
from tests.lives.units import Bench, benches
from tests.patience import LONG

API = "/api/v1"
MOST = {"sessions": 1000, "units": 1000, "unit-types": 1000, "uploads": 50}
"""Longest page of a list."""
ADMIN, SECRET = "a.admin", 30
"""An account, and the characters that a secret has and other words of a command have not."""
PENDING = "still running"
"""Said by a refusal of what rests on a diagnosis that is not there yet: documented, and to be asked again."""


class FindError(BaseException):
    """Raised for what must never be seen of the service.

    No `Exception`: Hypothesis would live the whole life again to say it better.
    """


@dataclass
class World:
    """One life of a service."""

    service: Service
    chance: Random
    """Decides what is not a step's own choice: noise, and what is looked at after a step."""
    benches: dict[str, Bench]
    http: httpx.Client
    stored: dict[str, bytes] = field(default_factory=dict)
    """Acknowledged uploads by their session's id."""
    typeless: set[str] = field(default_factory=set)
    """Sessions whose files name no type of unit."""
    rescaled: set[str] = field(default_factory=set)
    """Units of which some file reads all in another unit or range."""
    chosen: list[str] = field(default_factory=list)
    """Sessions that were made references, in that order."""
    journal: list[str] = field(default_factory=list)
    """Every request that changed something, and its answer's status."""
    counts: Counter[str] = field(default_factory=Counter)
    refused: Counter[str] = field(default_factory=Counter)
    """Reasons for refused uploads."""
    services: dict[int, tuple[str, dict[str, Any]]] = field(default_factory=dict)
    """Recorded services that count: the unit, and what was said of it, by number."""
    certificates: list[tuple[str, dict[str, Any]]] = field(default_factory=list)
    """Certificates of stands as recorded: address and body."""
    tolerances: dict[tuple[str, int], dict[str, Any]] = field(default_factory=dict)
    """Tolerances set of unit types, by name and revision."""
    is_dated: bool = False
    """Whether something was stated that holds from then on: other tolerances, a cause in a model."""
    is_short: bool = False
    """Whether expensive checks are left out."""
    has_accounts: bool = False
    _seen: tuple[Path | None, int] = (None, 0)
    """Log file and position up to which it was read."""
    _listed: dict[str, list[dict[str, Any]]] = field(default_factory=dict)
    _description: dict[str, Any] = field(default_factory=dict)

    def ask(self, method: str, path: str, **how: Any) -> httpx.Response:
        """An answer of the service, which is never a fault of its own."""
        answer = self.http.request(method, path, **how)
        self.counts["requests"] += 1
        if method != "GET":
            self._listed.clear()
            self.journal.append(f"{method} {path} {_told(how)} → {answer.status_code}")
        if answer.status_code >= 500 and not self.is_pending(answer):
            raise FindError(f"{method} {path} → {answer.status_code}: {answer.text[:600]}\n{self.new_log()}")
        return answer

    def get(self, path: str, **how: Any) -> Any:
        """The document of an address that exists, as a program reads it."""
        answer = self.ask("GET", f"{API}{path}", **how)
        if answer.status_code != 200:
            raise FindError(f"GET {path} → {answer.status_code}: {answer.text[:600]}")
        return answer.json()

    def get_description(self) -> dict[str, Any]:
        """The service's description of its operations."""
        if not self._description:
            self._description.update(self.ask("GET", "/openapi.json").json())
        return self._description

    def send(self, path: str, body: Any = None, method: str = "POST") -> httpx.Response:
        """A request of a program that changes something."""
        return self.ask(method, f"{API}{path}", json=body)

    @staticmethod
    def is_pending(answer: httpx.Response) -> bool:
        """Whether to ask again, because something is being made."""
        return answer.status_code == 202 or (answer.status_code == 503 and PENDING in answer.text)

    def new_log(self) -> str:
        """Output of the service since the last look, without its requests."""
        path, start = self._seen
        content = self.service.log.read_bytes() if self.service.log.exists() else b""
        start = start if path == self.service.log else 0
        self._seen = (self.service.log, len(content))
        lines = content[start:].decode("utf-8", errors="replace").splitlines()
        return "\n".join(line for line in lines if '"event": "request"' not in line)

    def restart(self, *, kill: bool) -> None:
        """Ends the service, politely or not, and starts it again."""
        self.journal.append("kill" if kill else "restart")
        self.counts["kills" if kill else "restarts"] += 1
        self.service.stop(signal.SIGKILL if kill else signal.SIGTERM)
        self.http.base_url = self.service.start()
        self.forget()

    def sign_in(self) -> None:
        """Requires everybody to sign in from now on; the test does as an admin, with a token."""
        self.has_accounts = True
        self.journal.append("first account")
        self._command("user", "add", ADMIN, "--role", "admin", *self.service.where)
        self.http.headers.update(self.token("admin", 90))
        self.get("/me")

    def token(self, role: str, days: int) -> dict[str, str]:
        """The header of a new token of the first account, made at the machine as only people may."""
        what = ("token", "add", ADMIN, "--role", role, "--label", "hall 3", "--days", str(days))
        output = self._command(*what, *self.service.where)
        secret = next(word for line in output.splitlines() for word in line.split() if len(word) > SECRET)
        self.forget()
        return {"Authorization": f"Bearer {secret}"}

    def _command(self, *arguments: str) -> str:
        code, output = self.service.command(*arguments)
        if code:
            raise FindError(f"imu-health {' '.join(arguments)} → {code}: {output}")
        return output

    def listed(self, what: str) -> list[dict[str, Any]]:
        """All that there is of a kind, as it was listed since the last change."""
        if what not in self._listed:
            answer = self.get(f"/{what}", params={"limit": MOST[what]} if what in MOST else {})
            self._listed[what] = answer[what.replace("-", "_")]
        return self._listed[what]

    def sessions(self, *states: str, unit: str | None = None) -> list[dict[str, Any]]:
        """Sessions at hand, in some states or in any, of a unit or of all."""
        return [
            one
            for one in self.listed("sessions")
            if (not states or one["state"] in states) and unit in (None, one["unit"])
        ]

    def units(self) -> list[str]:
        """Serial numbers that the service knows."""
        return [unit["serial"] for unit in self.listed("units")]

    def forget(self) -> None:
        """Forgets the lists, so that they are read anew."""
        self._listed.clear()


@contextmanager
def opened(service: Service, seed: int) -> Iterator[World]:
    """A world around a service that is started here and ended here."""
    chance = Random(seed)
    address = service.start()
    with httpx.Client(base_url=address, timeout=LONG, follow_redirects=False, trust_env=False) as http:
        try:
            yield World(service, chance, benches(seed), http)
        finally:
            service.stop()


def _told(how: dict[str, Any]) -> str:
    body = how.get("json") or how.get("params") or how.get("data") or ""
    return json.dumps(body, ensure_ascii=False)[:300] if body else ""
