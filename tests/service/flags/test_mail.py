"""E-mail beside webhooks, to a real mail server on this machine: sent once, tried again, only where one is named."""

import socketserver
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from email import message_from_string
from email.header import decode_header, make_header
from email.message import Message
from threading import Thread

import pytest

from service.app import create_app
from service.errors import RefusedError
from service.flags.changes import fault_of, register_webhook, resolve_flag
from service.flags.mail import MailServer
from service.flags.messages import Ways, deliver_due
from service.flags.records import DeliveryState
from service.flags.webhooks_store import Webhooks
from service.jobs.store import Failures
from service.kit.metrics import Metrics
from service.settings import Settings
from service.storage import Storage
from service.uploads.receive import upload
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import FAILED
from tests.serving import http_client

CREW = "mailto:crew@example.org"
NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


@dataclass
class Mailbox:
    """Mailbox of a mail server."""

    port: int = 0
    refusals: int = 0
    """Number of messages that are put off."""
    messages: list[str] = field(default_factory=list)

    @property
    def server(self) -> MailServer:
        """It, without encryption."""
        return MailServer("127.0.0.1", self.port, "imu@example.org", "none")


class Handler(socketserver.StreamRequestHandler):
    """SMTP (RFC 5321) as far as one client needs it."""

    def handle(self) -> None:
        """One connection."""
        box: Mailbox = self.server.box  # type: ignore[attr-defined]
        self.say("220 ready")
        while line := self.rfile.readline().decode().strip():
            word = line.upper().split(" ")[0]
            if word == "DATA" and box.refusals:
                box.refusals -= 1
                self.say("451 try again later")
            elif word == "DATA":
                self.say("354 go on")
                lines = iter(lambda: self.rfile.readline().decode(), ".\r\n")
                box.messages.append("".join(lines))
                self.say("250 taken")
            else:
                self.say("221 bye" if word == "QUIT" else "250 fine")

    def say(self, line: str) -> None:
        """One answer."""
        self.wfile.write(f"{line}\r\n".encode())


@contextmanager
def mail_server() -> Iterator[Mailbox]:
    """A mail server until the block ends."""
    box = Mailbox()
    with socketserver.ThreadingTCPServer(("127.0.0.1", 0), Handler) as server:
        server.box = box  # type: ignore[attr-defined]
        box.port = server.server_address[1]
        Thread(target=server.serve_forever, args=(0.01,), daemon=True).start()
        yield box
        server.shutdown()


@pytest.fixture
def box() -> Iterator[Mailbox]:
    """A mail server."""
    with mail_server() as found:
        yield found


def failed_unit(storage: Storage, serial: str = "BA-017") -> int:
    """A unit whose verdict has changed and that has a flag; the number of the address that messages go to."""
    id = register_webhook(storage, (), CREW, "", who="K. Ito", now=NOW, has_mail=True).id
    for content in FAILED:
        upload(storage, content.replace(b"BA-017", serial.encode()), "a.json", NOW)
    return id


def written(message: Message) -> str:
    """The text of a message."""
    content = message.get_payload(decode=True)
    assert isinstance(content, bytes)
    return content.decode()


def test_flags_and_verdicts_are_sent_and_put_off_messages_follow_later(storage: Storage, box: Mailbox) -> None:
    id, ways = failed_unit(storage), Ways(mail=box.server)
    box.refusals = 2
    deliver_due(storage, ways, lambda: NOW, Metrics())
    assert box.messages == []
    deliver_due(storage, ways, lambda: NOW + timedelta(minutes=5), Metrics())
    deliver_due(storage, ways, lambda: NOW + timedelta(minutes=9), Metrics())
    sent = [message_from_string(one) for one in box.messages]
    assert [one["To"] for one in sent] == ["crew@example.org"] * 2
    assert str(make_header(decode_header(sent[1]["Subject"]))).startswith("BA-017: A3 bias changed by")
    assert len({one["Message-ID"] for one in sent}) == 2
    with storage.database.reading() as store:
        assert {one.state for one in Webhooks(store).deliveries(id, 10)} == {DeliveryState.DELIVERED}


FORGED = "=?utf-8?q?BA=0d=0aBcc:_x@example.net=0d=0a=0d=0aforged?="
"""A serial number that mail readers would decode into a header, its end and a body."""


def test_no_text_of_a_unit_or_a_person_becomes_a_header_or_ends_one(storage: Storage, box: Mailbox) -> None:
    failed_unit(storage, FORGED)
    assert deliver_due(storage, Ways(mail=box.server), lambda: NOW, Metrics()) == 2
    for one in map(message_from_string, box.messages):
        assert set(one) == {
            "Content-Type", "MIME-Version", "Content-Transfer-Encoding", "From", "To", "Subject", "Date", "Message-ID"
        }  # fmt: skip
        assert str(make_header(decode_header(one["Subject"]))).startswith(f"{FORGED}: ")
        assert f"Unit {FORGED}, " in written(one)


@pytest.mark.parametrize("control", ["\r", "\r\n", "\v", "\f", "\x00", "\x1b", "\x85", "\u2028", "\u2029"])
def test_a_reason_with_control_characters_that_an_earlier_release_stored_is_sent(
    storage: Storage, box: Mailbox, control: str
) -> None:
    failed_unit(storage)
    resolve_flag(storage, 1, "K. Ito", f"seat{control}dirty", NOW)
    assert deliver_due(storage, Ways(mail=box.server), lambda: NOW, Metrics()) == 3
    last = message_from_string(box.messages[-1])
    assert str(make_header(decode_header(last["Subject"]))) == "BA-017: seat dirty"
    assert written(last).startswith(("seat dirty\n", "seat\ndirty\n"))


def test_a_message_that_cannot_be_made_is_given_up_at_once_and_listed_as_failed_work(
    storage: Storage, box: Mailbox, monkeypatch: pytest.MonkeyPatch
) -> None:
    def unmade(*_: object) -> None:
        raise ValueError("no such header")

    id = failed_unit(storage)
    monkeypatch.setattr("service.flags.mail._message", unmade)
    assert deliver_due(storage, Ways(mail=box.server), lambda: NOW, Metrics()) == 2
    with storage.database.reading() as store:
        assert {one.state for one in Webhooks(store).deliveries(id, 10)} == {DeliveryState.FAILED}
        assert [one.of for one in Failures(store).listed(NOW, 10)] == [f"webhook {id}"] * 2
    assert deliver_due(storage, Ways(mail=box.server), lambda: NOW + timedelta(days=2), Metrics()) == 0


def test_without_a_mail_server_no_address_is_taken(storage: Storage) -> None:
    with pytest.raises(RefusedError):
        register_webhook(storage, (), CREW, "", who="K. Ito", now=NOW)


@pytest.mark.parametrize(
    "url", ["mailto:crew", "mailto:a@b.org,c@d.org", "mailto:a@b.org?bcc=c@d.org", "mailto:a b@c.org"]
)
def test_what_is_no_single_address_is_refused(url: str) -> None:
    assert "no e-mail address" in fault_of(url, (), has_mail=True)


def test_it_is_registered_over_http(settings: Settings, box: Mailbox) -> None:
    server = {"mail_host": "127.0.0.1", "mail_port": box.port, "mail_from": "imu@example.org", "mail_security": "none"}
    with http_client(create_app(settings.model_copy(update=server))) as client:
        assert client.post("/api/v1/webhooks", json={"url": CREW, "by": "K. Ito"}).status_code == 201
        refused = client.post("/api/v1/webhooks", json={"url": "https://example.org/hook", "by": "K. Ito"})
        assert refused.status_code == 422
