"""Work beside the requests: diagnoses that were asked for, each made by one process of all services on the database.

What is to be made stands in the database. Whoever begins one claims it there for a short time, and says again and again
that he is still at it. Where a process dies the claim runs out and another one begins anew.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from threading import Event
from uuid import uuid4

from service.background.bell import Bell
from service.background.helper import Helper, StoppingError
from service.flows.diagnose import give_up
from service.flows.guard import Failure, Guard
from service.log import log
from service.metrics import Metrics
from service.records.pending import Claim
from service.settings import VERSION, Settings
from service.storage import Storage

CLAIM = timedelta(seconds=30)
"""That a claim holds: what a dead service was at is begun anew after it."""
EXTEND = timedelta(seconds=10)
"""Between two words that somebody is still at it."""
PUT_OFF = timedelta(minutes=10)
"""After a try that failed, as on a file that is lost; whoever reads the diagnosis tries at once."""
MOST_ATTEMPTS = 3
"""Tries at which the program may fail, or its process die, before a diagnosis is given up: two could be a machine in
need."""
WORK = "pending diagnoses"
"""As the log and the figures name it."""


@dataclass(frozen=True)
class Diagnosing:
    """What making diagnoses beside the requests takes."""

    settings: Settings
    storage: Storage
    clock: Callable[[], datetime]
    metrics: Metrics
    bell: Bell
    who: str = field(default_factory=lambda: uuid4().hex)
    """Signs the claims."""


def diagnose_next(own: Diagnosing, helper: Helper, stop: Event) -> bool:
    """Makes the diagnosis that is next; whether there was one."""
    now = own.clock()
    claimed = _claimed(own, now)
    if claimed is None:
        return False
    claim, attempts = claimed
    if attempts > MOST_ATTEMPTS:
        give_up(own.storage, claim.session, now)
    else:
        _diagnose(own, helper, claim, stop)
    own.bell.ring()
    return True


def _claimed(own: Diagnosing, now: datetime) -> tuple[Claim, int] | None:
    """What somebody waits for, and else what was asked for first; with how often it was begun."""
    urgent = own.bell.urgent()
    with own.storage.database.reading() as store:
        waiting = store.pending.waiting(now, 1 + own.settings.diagnosis_workers)
    for id in waiting if urgent is None else (urgent, *waiting):
        claim = Claim(id, own.who, now + CLAIM)
        with own.storage.database.writing() as store:
            attempts = store.pending.claim(claim, now)
        if attempts is not None:
            return claim, attempts
    return None


def _diagnose(own: Diagnosing, helper: Helper, claim: Claim, stop: Event) -> None:
    """Whatever hinders it leaves it asked for."""
    begun = own.clock()
    last = begun

    def still() -> bool:
        nonlocal last
        now = own.clock()
        if now - last > EXTEND:
            last = now
            with own.storage.database.writing() as store:
                store.pending.extend(Claim(claim.session, claim.who, now + CLAIM))
        return not stop.is_set()

    try:
        failure = helper.diagnose(claim.session, begun, still)
    except StoppingError:
        with own.storage.database.writing() as store:
            store.pending.put_off(claim, None)
    else:
        if failure is not None:
            _leave(own, claim, failure)


def _leave(own: Diagnosing, claim: Claim, failure: Failure) -> None:
    """What is foreseen passes, and is tried for ever; at what is not, a few times."""
    _note(own, claim, failure)
    with own.storage.database.writing() as store:
        store.pending.hold_up(claim.session, failure.reason)
        if failure.is_foreseen:
            store.pending.put_off(claim, own.clock() + PUT_OFF)
        else:
            store.pending.give_back(claim)


def _note(own: Diagnosing, claim: Claim, failure: Failure) -> None:
    log.warning("diagnosis pending", session=claim.session, reason=failure.reason)
    own.metrics.count_fault(WORK, failure.fault)


BATCH = 500
"""Sessions that one query brings."""


def ask_for_missing(storage: Storage, clock: Callable[[], datetime], metrics: Metrics, bell: Bell, stop: Event) -> None:
    """At the start: asks for the diagnosis of every session that has none, or on which an older version failed; what
    failed is tried again."""
    last = ""
    with Guard(metrics).alone(WORK, ""):
        with storage.database.writing() as store:
            store.failures.try_again()
        while not stop.is_set():
            with storage.database.reading() as store:
                missing = store.sessions.without_diagnosis(last, BATCH, VERSION)
            if not missing:
                return
            with storage.database.writing() as store:
                store.pending.add(missing, clock())
            bell.ring()
            last = missing[-1]
