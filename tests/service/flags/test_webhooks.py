"""Webhooks over real HTTP: signed, durable, at least once, and only to hosts that the operator allows."""

import hashlib
import hmac
import json
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta
from threading import Event
from threading import enumerate as enumerate_threads

import httpx
import pytest

from service.app import create_app
from service.flags.changes import fault_of, register_webhook, remove_webhook
from service.flags.messages import CLAIM, MOST_ATTEMPTS, Ways, deliver_due
from service.flags.records import DeliveryState
from service.flags.webhooks_store import Webhooks
from service.kit.metrics import Metrics
from service.settings import Settings
from service.storage import Storage
from service.uploads.receive import upload
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import FAILED, session_bytes
from tests.service.receiver import Receiver, receiver
from tests.serving import http_client

SECRET = "sixteen or more letters"
NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


@pytest.fixture
def hook() -> Iterator[Receiver]:
    """A receiver."""
    with receiver() as found:
        yield found


def body(hook: Receiver) -> dict[str, str]:
    return {"url": hook.url, "secret": SECRET, "by": "K. Ito"}


def test_a_flag_and_a_verdict_are_told_signed(
    settings: Settings, hook: Receiver, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.flags.messages.LOOK_EVERY", 0.01)
    allowed = settings.model_copy(update={"webhook_hosts": (hook.host,)})
    with http_client(create_app(allowed)) as client:
        registered = client.post("/api/v1/webhooks", json=body(hook))
        assert registered.status_code == 201
        assert SECRET not in registered.text + client.get("/api/v1/webhooks").text
        for content in FAILED:
            client.post("/api/v1/sessions", content=content).raise_for_status()
        messages = hook.wait_for(2)
        told = [json.loads(message.body) for message in messages]
        assert [one["type"] for one in told] == ["verdict.changed", "flag.raised"]
        assert told[1]["flag"] == {"id": 1, "matter": "out-of-tolerance", "place": "A3"}
        for message, one in zip(messages, told, strict=True):
            expected = hmac.new(SECRET.encode(), message.body, hashlib.sha256).hexdigest()
            assert message.headers["X-Imu-Health-Signature"] == f"sha256={expected}"
            assert message.headers["Idempotency-Key"] == one["id"]
        path = f"/api/v1/webhooks/{registered.json()['id']}"
        assert {d["state"] for d in client.get(f"{path}/deliveries").json()["deliveries"]} <= {"delivered", "waiting"}
        assert client.delete(path, params={"by": "K. Ito"}).status_code == 204
        assert client.get("/api/v1/webhooks").json() == {"webhooks": []}
        assert client.get(f"{path}/deliveries").status_code == 404


def test_a_receiver_that_does_not_answer_keeps_neither_the_others_waiting_nor_the_stop(
    settings: Settings, hook: Receiver, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.flags.messages.LOOK_EVERY", 0.01)
    with receiver() as slow:
        slow.held = Event()
        allowed = settings.model_copy(update={"webhook_hosts": (slow.host, hook.host)})
        with http_client(create_app(allowed)) as client:
            for one in (slow, hook):
                assert client.post("/api/v1/webhooks", json=body(one)).status_code == 201
            for content in FAILED:
                client.post("/api/v1/sessions", content=content).raise_for_status()
            hook.wait_for(2)
            slow.wait_for(1)
            assert len(slow.messages) == 1
        assert "outbox" not in {thread.name for thread in enumerate_threads()}
        slow.held.set()


def test_an_attempt_ends_in_time_whatever_the_receiver_does(outbox: "Outbox", monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.flags.messages.LONGEST_ATTEMPT", 0.05)
    outbox.hook.held = Event()
    assert outbox.deliver() == 2
    outbox.hook.held.set()
    assert {outcome for _, _, outcome in outbox.states()} == {"no answer within 0.05 s"}


def test_without_an_allowed_host_nothing_can_be_registered(client: httpx.Client, hook: Receiver) -> None:
    answer = client.post("/api/v1/webhooks", json=body(hook))
    assert (answer.status_code, answer.json()["problems"][0]["field"]) == (422, "url")
    assert "IMU_HEALTH_WEBHOOK_HOSTS" in answer.json()["problems"][0]["message"]


@pytest.mark.parametrize(
    "url",
    [
        "http://127.0.0.1:9/",
        "http://127.1/",
        "http://2130706433/",
        "http://0x7f.0.0.1/",
        "http://[::1]/",
        "http://[::ffff:127.0.0.1]/",
        "http://localhost/",
        "http://169.254.169.254/latest/meta-data",
        "http://hooks.example.org@127.0.0.1/",
        "http://hooks.example.org:80@127.0.0.1/",
        "http://hooks.example.org:8080/",
        "http://hooks.example.org.evil.example/",
        "http://hooks.example.org./",
        "http://hooks.example.org\\@127.0.0.1/",
        "http://evil.example/#hooks.example.org",
        "http://evil.example?hooks.example.org",
        "file:///etc/passwd",
        "ftp://hooks.example.org/",
        "//hooks.example.org/",
        "hooks.example.org",
        "http://",
        "http://user:password@hooks.example.org/",
    ],
)
def test_no_spelling_leads_elsewhere(url: str) -> None:
    assert fault_of(url, ("hooks.example.org",))


def test_an_allowed_host_may_be_called_at_its_port_only() -> None:
    assert not fault_of("https://hooks.example.org/a?b=c", ("hooks.example.org",))
    assert not fault_of("http://HOOKS.example.org:80/", ("hooks.example.org",))
    assert not fault_of("http://10.0.0.5:8443/", ("10.0.0.5:8443",))
    assert fault_of("http://10.0.0.5/", ("10.0.0.5:8443",))
    assert fault_of("https://10.0.0.5:443/", ())


def delivered(storage: Storage, hosts: tuple[str, ...], clock: Callable[[], datetime]) -> int:
    """Delivers in a thread of its own: the loop of a browser may run in this one."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(deliver_due, storage, Ways(hosts), clock, Metrics()).result()


class Outbox:
    """A unit whose verdict has changed, one message waiting for each notice, and a clock that is set by hand."""

    def __init__(self, storage: Storage, hook: Receiver) -> None:
        self.storage, self.hook, self.now = storage, hook, NOW
        self.id = register_webhook(storage, (hook.host,), hook.url, SECRET, who="K. Ito", now=NOW).id
        for content in FAILED:
            upload(storage, content, "a.json", NOW)

    def deliver(self, hosts: tuple[str, ...] | None = None) -> int:
        """Attempts what is due now."""
        allowed = (self.hook.host,) if hosts is None else hosts
        return delivered(self.storage, allowed, lambda: self.now)

    def states(self) -> list[tuple[DeliveryState, int, str]]:
        """State, attempts and outcome of every delivery, oldest first."""
        with self.storage.database.reading() as store:
            found = Webhooks(store).deliveries(self.id, 100)
        return [(d.state, d.attempts, d.outcome) for d in reversed(found)]


@pytest.fixture
def outbox(storage: Storage, hook: Receiver) -> Outbox:
    return Outbox(storage, hook)


def test_what_is_refused_is_sent_again_later_under_the_same_key(outbox: Outbox) -> None:
    outbox.hook.statuses += [500, 503]
    assert outbox.deliver() == 2
    assert outbox.deliver() == 0
    outbox.now += timedelta(seconds=11)
    assert outbox.deliver() == 2
    first, second, again, more = outbox.hook.messages
    assert [(m.body, m.headers["Idempotency-Key"]) for m in (again, more)] == [
        (m.body, m.headers["Idempotency-Key"]) for m in (first, second)
    ]
    assert {state[:2] for state in outbox.states()} == {(DeliveryState.DELIVERED, 2)}


def test_a_redirect_is_not_followed(outbox: Outbox) -> None:
    outbox.hook.statuses += [302, 307]
    outbox.deliver()
    assert {message.path for message in outbox.hook.messages} == {"/hook"}
    assert [state[0] for state in outbox.states()] == [DeliveryState.WAITING] * 2


def test_a_host_that_is_no_longer_allowed_is_not_called(outbox: Outbox) -> None:
    outbox.deliver(hosts=())
    assert outbox.hook.messages == []
    assert "may not call" in outbox.states()[0][2]


def test_a_delivery_that_was_cut_short_is_made_again(outbox: Outbox) -> None:
    with outbox.storage.database.writing() as store:
        claimed = Webhooks(store).claim(NOW, NOW + CLAIM, 10)
    assert (len(claimed), outbox.deliver()) == (2, 0)
    outbox.now += CLAIM
    assert outbox.deliver() == 2
    assert len(outbox.hook.messages) == 2


@pytest.mark.slow
def test_pauses_grow_and_end_within_a_day(outbox: Outbox) -> None:
    outbox.hook.statuses += [500] * 2 * MOST_ATTEMPTS
    for _ in range(MOST_ATTEMPTS):
        assert outbox.deliver() == 2
        outbox.now += timedelta(hours=1, seconds=1)
    assert outbox.deliver() == 0
    assert outbox.states() == [(DeliveryState.FAILED, MOST_ATTEMPTS, "500 Internal Server Error")] * 2


def test_a_removed_webhook_is_told_no_more(outbox: Outbox) -> None:
    remove_webhook(outbox.storage, outbox.id, "K. Ito", NOW)
    upload(outbox.storage, session_bytes(seed=3, month=3), "a.json", NOW)
    assert outbox.deliver() == 0
    assert {state for state, _, _ in outbox.states()} == {DeliveryState.FAILED}


def test_a_receiver_that_is_away_keeps_no_upload_waiting(storage: Storage) -> None:
    nowhere = "http://127.0.0.1:9/hook"
    register_webhook(storage, ("127.0.0.1:9",), nowhere, SECRET, who="K. Ito", now=NOW)
    for content in FAILED:
        assert upload(storage, content, "a.json", NOW).created
    assert delivered(storage, ("127.0.0.1:9",), lambda: NOW) == 2
    with storage.database.reading() as store:
        assert all("ConnectError" in d.outcome for d in Webhooks(store).deliveries(1, 10))
