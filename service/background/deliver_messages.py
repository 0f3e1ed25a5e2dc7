"""Work beside the requests: what lies in the outbox is sent, signed, until it is accepted or given up; at least once.

An attempt is claimed before it is made. If the service dies in between, the claim runs out and the notice is sent
again under the same key, by which the receiver knows it.
"""

import hashlib
import hmac
import json
from collections.abc import Callable
from datetime import datetime, timedelta
from threading import Event

import httpx

from service.background.guard import Guard
from service.flows.register_webhook import fault_of
from service.metrics import Metrics
from service.records.webhook import DeliveryState, Outgoing
from service.storage import Storage

AT_A_TIME = 20
"""Messages that are claimed together: few enough that a claim outlasts them."""
CLAIM = timedelta(minutes=10)
"""Longer than `AT_A_TIME` attempts that all time out."""
TIMEOUT = httpx.Timeout(10.0, connect=5.0)
"""Seconds: a receiver that takes longer should accept first and work after."""
FIRST_PAUSE, LONGEST_PAUSE = timedelta(seconds=10), timedelta(hours=1)
"""A restart of the receiver is waited for, and an hour after it is back at most everything has been told."""
MOST_ATTEMPTS = 30
"""Over about 21 hours."""
LOOK_EVERY = 1.0
"""Seconds between two looks into the outbox."""
LONGEST_WAIT = 60.0
"""Seconds between two looks while they fail, as when the database is away: after a minute at most it goes on."""
SIGNATURE, KEY = "X-Imu-Health-Signature", "Idempotency-Key"
"""Header of the HMAC; header of the message's key (IETF draft idempotency-key-header)."""


def deliver_until(
    storage: Storage, hosts: tuple[str, ...], clock: Callable[[], datetime], metrics: Metrics, stop: Event
) -> None:
    """Empties the outbox until ``stop`` is set, with longer pauses while that fails."""
    pause, guard = LOOK_EVERY, Guard(metrics)
    with httpx.Client(timeout=TIMEOUT, follow_redirects=False, trust_env=False) as http:
        while not stop.wait(pause):
            failed = guard.failed
            with guard.alone("outbox", ""):
                while deliver_due(storage, hosts, clock, http) == AT_A_TIME and not stop.is_set():
                    pass
            pause = LOOK_EVERY if guard.failed == failed else min(2 * pause, LONGEST_WAIT)


def deliver_due(storage: Storage, hosts: tuple[str, ...], clock: Callable[[], datetime], http: httpx.Client) -> int:
    """Attempts what is due, and returns how much that was."""
    now = clock()
    with storage.database.reading() as store:
        if not store.webhooks.is_due(now):
            return 0
    with storage.database.writing() as store:
        due = store.webhooks.claim(now, now + CLAIM, AT_A_TIME)
    for outgoing in due:
        accepted, outcome = _attempt(outgoing, hosts, http)
        state, next_at = _after(outgoing, accepted, clock())
        with storage.database.writing() as store:
            store.webhooks.put(outgoing.delivery, state, outcome, next_at)
    return len(due)


def _attempt(outgoing: Outgoing, hosts: tuple[str, ...], http: httpx.Client) -> tuple[bool, str]:
    """Whether the receiver accepted, and what it said; its answer's body is never read."""
    fault = fault_of(outgoing.webhook.url, hosts)
    if fault:
        return False, f"the address {fault}"
    body = payload(outgoing)
    headers = {
        "Content-Type": "application/json",
        "User-Agent": "imu-health",
        KEY: outgoing.notice.key,
        SIGNATURE: f"sha256={signature(outgoing.webhook.secret, body)}",
    }
    try:
        with http.stream("POST", outgoing.webhook.url, content=body, headers=headers) as answer:
            return answer.is_success, f"{answer.status_code} {answer.reason_phrase}".strip()
    except (httpx.HTTPError, httpx.InvalidURL) as problem:
        return False, f"{type(problem).__name__}: {problem}"


def _after(outgoing: Outgoing, accepted: bool, now: datetime) -> tuple[DeliveryState, datetime]:
    """Pauses double from one attempt to the next."""
    if accepted:
        return DeliveryState.DELIVERED, now
    if outgoing.attempt >= MOST_ATTEMPTS:
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
