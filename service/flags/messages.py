"""Background work: the messages of the outbox are sent, signed, until they are accepted or given up; at least once.

An attempt is claimed before it is made. If the service dies in between, the claim runs out and the notice is sent again
under the same key, by which the receiver knows it. Every receiver has a turn of its own: while one keeps the service
waiting, the others get theirs, and a service that stops waits for none.
"""

import asyncio
import hashlib
import hmac
import json
from collections.abc import AsyncIterator, Callable, Collection, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass
from datetime import datetime, timedelta
from threading import Event

from service.flags.changes import fault_of
from service.flags.mail import NO_MAIL, SCHEME, MailServer, send
from service.flags.records import DeliveryState, Outgoing
from service.flags.webhooks_store import Webhooks
from service.kit.failure import AT_FAULT
from service.kit.guard import Guard
from service.kit.libraries import httpx
from service.kit.metrics import Metrics
from service.kit.text import in_one_line
from service.storage import Storage

AT_A_TIME = 20
"""Messages that are claimed together: few enough that a claim outlasts them, were they all for one receiver."""
CLAIM = timedelta(minutes=10)
"""Longer than `AT_A_TIME` attempts that all time out."""
LONGEST_ATTEMPT, CONNECTING = 10.0, 5.0
"""Seconds, all together, and to connect: a receiver that takes longer should accept first and work after."""
MOST_AT_ONCE = 16
"""Receivers that are sent to at once; one that holds its connection open holds a socket, and no more."""
FIRST_PAUSE, LONGEST_PAUSE = timedelta(seconds=10), timedelta(hours=1)
"""A restart of the receiver is waited for, and at most an hour after it is back everything has been sent."""
MOST_ATTEMPTS = 30
"""Most attempts, over about 21 hours."""
LOOK_EVERY = 1.0
"""Seconds between two looks into the outbox."""
LONGEST_WAIT = 60.0
"""Seconds between two looks while they fail, as when the database is away: after a minute at most it goes on."""
SIGNATURE, KEY = "X-Imu-Health-Signature", "Idempotency-Key"
"""Header of the HMAC; header of the message's key (IETF draft idempotency-key-header)."""


def deliver_until(storage: Storage, ways: "Ways", clock: Callable[[], datetime], metrics: Metrics, stop: Event) -> None:
    """Empties the outbox until ``stop`` is set, with longer pauses while that fails."""
    asyncio.run(_deliver_until(Outbox(storage, ways, clock), Guard(metrics), stop))


async def _deliver_until(outbox: "Outbox", guard: Guard, stop: Event) -> None:
    pause = LOOK_EVERY
    async with turns_of(outbox, guard) as turns:
        while not await asyncio.to_thread(stop.wait, pause):
            failed = guard.failed
            with guard.alone("outbox", ""):
                while await turns.begin() == AT_A_TIME and not stop.is_set():
                    pass
            pause = LOOK_EVERY if guard.failed == failed else min(2 * pause, LONGEST_WAIT)


def deliver_due(storage: Storage, ways: "Ways", clock: Callable[[], datetime], metrics: Metrics) -> int:
    """Attempts all due messages, waits for every receiver, and returns their number."""

    async def once() -> int:
        async with turns_of(Outbox(storage, ways, clock), Guard(metrics)) as turns:
            count = await turns.begin()
            await turns.done()
            return count

    return asyncio.run(once())


@dataclass(frozen=True)
class Ways:
    """Permitted ways of messages."""

    hosts: tuple[str, ...] = ()
    """Hosts of webhooks."""
    mail: MailServer = NO_MAIL


@dataclass(frozen=True)
class Outbox:
    """Messages to be sent, and their permitted ways."""

    storage: Storage
    ways: Ways
    clock: Callable[[], datetime]

    def claim(self, busy: Collection[int]) -> tuple[Outgoing, ...]:
        """The due messages, oldest first, except for receivers that have their turn."""
        now = self.clock()
        with self.storage.database.reading() as store:
            if not Webhooks(store).is_due(now, busy):
                return ()
        with self.storage.database.writing() as store:
            return Webhooks(store).claim(now, now + CLAIM, AT_A_TIME, busy)

    def put(self, outgoing: Outgoing, ended: "Ended") -> None:
        """Stores the outcome of an attempt."""
        state, at = _after(outgoing, ended, self.clock())
        with self.storage.database.writing() as store:
            Webhooks(store).put(outgoing.delivery, state, ended.outcome, at)


@dataclass(frozen=True)
class Ended:
    """The outcome of an attempt."""

    accepted: bool
    outcome: str
    """The receiver's answer, or why it could not be asked."""
    is_last: bool = False
    """Whether another attempt would end the same way."""


UNSENT = Ended(accepted=False, outcome=AT_FAULT, is_last=True)
"""A message that the program cannot make or hand over."""


class DeliveryTurns:
    """Receivers that are being sent to: each in a turn of its own, so that a slow one keeps none of the others."""

    def __init__(self, outbox: Outbox, guard: Guard, http: "httpx.AsyncClient") -> None:
        self._outbox, self._guard, self._http = outbox, guard, http
        self._running: dict[int, asyncio.Task[None]] = {}

    async def begin(self) -> int:
        """Starts the turns of receivers that have something due and are at no turn; how many messages that is."""
        self._running = {id: turn for id, turn in self._running.items() if not turn.done()}
        if len(self._running) >= MOST_AT_ONCE:
            return 0
        claimed = await asyncio.to_thread(self._outbox.claim, tuple(self._running))
        for id in dict.fromkeys(outgoing.webhook.id for outgoing in claimed):
            of_webhook = [outgoing for outgoing in claimed if outgoing.webhook.id == id]
            self._running[id] = asyncio.create_task(self._turn(of_webhook))
        return len(claimed)

    async def done(self) -> None:
        """Waits until every turn has ended."""
        await asyncio.gather(*self._running.values())

    async def cancel(self) -> None:
        """Ends every turn now; claimed messages are sent again once the claim has run out."""
        for turn in self._running.values():
            turn.cancel()
        await asyncio.gather(*self._running.values(), return_exceptions=True)

    async def _turn(self, batch: Sequence[Outgoing]) -> None:
        """The messages of one receiver, one after another, oldest first."""
        for outgoing in batch:
            with self._guard.alone("outbox", outgoing.webhook.url):
                ended = UNSENT
                with self._guard.at_request("outbox", outgoing.webhook.url):
                    ended = await _attempt(outgoing, self._outbox.ways, self._http)
                await asyncio.to_thread(self._outbox.put, outgoing, ended)


@asynccontextmanager
async def turns_of(outbox: Outbox, guard: Guard) -> AsyncIterator[DeliveryTurns]:
    """Turns, which are cancelled at the end."""
    async with httpx.AsyncClient(
        timeout=httpx.Timeout(LONGEST_ATTEMPT, connect=CONNECTING), follow_redirects=False, trust_env=False
    ) as http:
        turns = DeliveryTurns(outbox, guard, http)
        try:
            yield turns
        finally:
            await turns.cancel()


async def _attempt(outgoing: Outgoing, ways: Ways, http: "httpx.AsyncClient") -> Ended:
    """Sends the message once; the body of the answer is never read."""
    fault = fault_of(outgoing.webhook.url, ways.hosts, has_mail=ways.mail.is_there)
    if fault:
        return Ended(False, f"the address {fault}")
    if outgoing.webhook.url.startswith(SCHEME):
        address = outgoing.webhook.url.removeprefix(SCHEME)
        return Ended(*await asyncio.to_thread(send, ways.mail, address, outgoing.notice))
    body = payload(outgoing)
    headers = {
        "Content-Type": "application/json",
        "User-Agent": "imu-health",
        KEY: outgoing.notice.key,
        SIGNATURE: f"sha256={signature(outgoing.webhook.secret, body)}",
    }
    try:
        async with asyncio.timeout(LONGEST_ATTEMPT):
            async with http.stream("POST", outgoing.webhook.url, content=body, headers=headers) as answer:
                said = f"{answer.status_code} {answer.reason_phrase}".strip()
                return Ended(answer.is_success, in_one_line(said))
    except TimeoutError:
        return Ended(False, f"no answer within {LONGEST_ATTEMPT:g} s")
    except (httpx.HTTPError, httpx.InvalidURL) as problem:
        return Ended(False, in_one_line(f"{type(problem).__name__}: {problem}"))


def _after(outgoing: Outgoing, ended: Ended, now: datetime) -> tuple[DeliveryState, datetime]:
    """State of a delivery after an attempt, and its end or next attempt: pauses double from one attempt to the next."""
    if ended.accepted:
        return DeliveryState.DELIVERED, now
    if ended.is_last or outgoing.attempt >= MOST_ATTEMPTS:
        return DeliveryState.FAILED, now
    doubled = FIRST_PAUSE * 2 ** min(outgoing.attempt - 1, 10)
    return DeliveryState.WAITING, now + min(doubled, LONGEST_PAUSE)


def payload(outgoing: Outgoing) -> bytes:
    """The message, the same at every attempt."""
    notice = outgoing.notice
    flag = None
    if notice.flag is not None and outgoing.matter is not None:
        flag = {"id": notice.flag, "matter": outgoing.matter.value, "place": outgoing.place}
    content = {
        "id": notice.key,
        "type": notice.kind.value,
        "at": notice.at.isoformat(),
        "unit": notice.unit,
        "text": notice.text,
        "who": notice.who,
        "flag": flag,
        "session": notice.session,
    }
    return json.dumps(content, ensure_ascii=False).encode()


def signature(secret: str, body: bytes) -> str:
    """HMAC-SHA256 of the body under the webhook's secret, 64 hexadecimal digits."""
    return hmac.new(secret.encode(), body, hashlib.sha256).hexdigest()
