"""Passwords are costly to hash: few are hashed at once, a short queue waits, others are asked to come again, and
everything else is answered meanwhile."""

from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from threading import Event, Lock

import httpx
import pytest

from service.app import create_app
from service.people import changes
from service.settings import Settings
from service.storage import Storage
from service.web.turns import PasswordTurns
from tests.databases import all_on_both_engines as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.people.staff import NOW, staffed
from tests.serving import http_client

MANY = 60


class SlowHash:
    """In place of hashing: ends when it is let, and knows how many ran at once."""

    def __init__(self) -> None:
        self.let, self.begun = Event(), Event()
        self.most = self._running = 0
        self._own = Lock()

    def __call__(self, *_: object) -> bool:
        """No password is right."""
        with self._own:
            self._running += 1
            self.most = max(self.most, self._running)
        self.begun.set()
        self.let.wait()
        with self._own:
            self._running -= 1
        return False


@pytest.fixture
def slow(monkeypatch: pytest.MonkeyPatch) -> SlowHash:
    """Hashing that ends when it is let."""
    hashing = SlowHash()
    monkeypatch.setattr(changes, "is_password", hashing)
    return hashing


@pytest.fixture
def client(settings: Settings, storage: Storage) -> Iterator[httpx.Client]:
    """A service with accounts."""
    staffed(storage, signing=("engineer",))
    with http_client(create_app(settings, clock=lambda: NOW)) as http:
        yield http


def attempt(client: httpx.Client) -> httpx.Response:
    """A sign-in with a wrong password."""
    return client.post("/sign-in", data={"login": "engineer", "password": "a guess or another"})


def test_few_are_hashed_at_once_and_everything_else_is_answered(client: httpx.Client, slow: SlowHash) -> None:
    with ThreadPoolExecutor(MANY) as pool:
        sent = [pool.submit(attempt, client) for _ in range(MANY)]
        answers = as_completed(sent)
        refused = [next(answers).result() for _ in range(MANY - PasswordTurns.at_once - PasswordTurns.most_waiting)]
        assert {answer.status_code for answer in refused} == {503}
        assert all(int(answer.headers["Retry-After"]) > 0 for answer in refused)
        slow.begun.wait()
        for path in ("/healthz", "/readyz", "/sign-in"):
            assert client.get(path).status_code == 200
        slow.let.set()
        rest = Counter(answer.result().status_code for answer in answers)
    assert slow.most == PasswordTurns.at_once
    assert sum(rest.values()) == PasswordTurns.at_once + PasswordTurns.most_waiting
    assert set(rest) == {401, 429}
