"""Flow: uploaded bytes → checked → calibrated under the model in force → judged → stored, once → diagnosed → counted.

The one entry of the API and of the pages.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime

from estimator.errors import SessionError
from service.errors import RefusedError, ServiceError
from service.flows.diagnose import diagnose_now_or_later
from service.flows.flagging.settle import Occasion
from service.flows.flagging.verdict import flag_verdict
from service.flows.keep import keep
from service.flows.refresh_outlook import refresh_outlook
from service.flows.refuse import refuse
from service.ingest.checked import Checked, check, plain_filename
from service.judging.calibrate import Calibrated, basis_of, calibrate
from service.judging.judge import judge_in_epoch
from service.judging.model_in_force import model_for
from service.judging.tolerances import type_of
from service.log import log
from service.metrics import Metrics
from service.records.decision import Judged
from service.records.received import Received, SentFile
from service.records.session import Receipt, StoredSession
from service.storage import Storage
from service.storage.files import content_hash
from service.storage.store import Store

ID_DIGITS = 20
"""Of the file's SHA-256: 80 bits, so that among a million sessions two share them with a chance of 4e-13."""
FEW = 4
"""Files whose diagnosis an upload waits for; those of more files are made after the answer."""


@dataclass(frozen=True)
class Reception:
    """What receiving takes, apart from the file."""

    storage: Storage
    coverage_factor: float
    metrics: Metrics
    later: Callable[[str], None]
    """Is given the id of a session that is to be diagnosed after the answer."""


def receive(reception: Reception, file: SentFile, now: datetime) -> Receipt:
    """Stores a session file with its verdict, diagnoses it and counts it; RefusedError when it cannot be used."""
    (outcome,) = receive_all(reception, (file,), now)
    if isinstance(outcome, RefusedError):
        raise outcome
    return outcome


def receive_all(reception: Reception, files: Sequence[SentFile], now: datetime) -> tuple[Receipt | RefusedError, ...]:
    """The same for several files, or why one cannot be used; all are stored before the first is diagnosed."""
    outcomes = tuple(_stored_or_refused(reception, file, now) for file in files)
    for receipt in outcomes:
        if isinstance(receipt, Receipt):
            _diagnose(reception, receipt.id, now, wait=len(files) <= FEW)
            reception.metrics.count_upload(receipt)
    return outcomes


def _stored_or_refused(reception: Reception, file: SentFile, now: datetime) -> Receipt | RefusedError:
    k = reception.coverage_factor
    try:
        return upload(reception.storage, file.content, file.filename, now, coverage_factor=k)
    except RefusedError as refusal:
        return refusal


def _diagnose(reception: Reception, id: str, now: datetime, *, wait: bool) -> None:
    """Now where that is quick, otherwise later; whatever hinders the diagnosis leaves it pending."""
    try:
        diagnose_now_or_later(reception.storage, id, now, reception.later, wait=wait)
    except ServiceError as fault:
        log.warning("diagnosis pending", session=id, reason=str(fault))


def upload(
    storage: Storage,
    content: bytes,
    filename: str,
    now: datetime,
    *,
    coverage_factor: float = 2.0,
    simulated: bool = False,
    who: str = "crew",
) -> Receipt:
    """Stores a session file with its calibration and verdict; the same bytes again give the same receipt.

    Raises RefusedError with every problem when the file cannot be used; then only the refusal is recorded.
    """
    received = Received(content, content_hash(content), plain_filename(filename), now, who, simulated)
    with storage.database.reading() as store:
        known = store.sessions.by_hash(received.sha256)
    if known is not None:
        return _receipt(known, created=False)
    try:
        calibrated = _calibrated(storage, check(content, received.filename, now))
    except SessionError as fault:
        raise refuse(storage, received, fault.problems) from fault
    storage.files.keep(content)
    with storage.database.writing() as store:
        return _store(store, received, calibrated, coverage_factor)


def _calibrated(storage: Storage, checked: Checked) -> Calibrated:
    """Under the model in force, with no transaction open; SessionError where the session does not tell enough."""
    with storage.database.reading() as store:
        basis = basis_of(store, checked, model_for(store, checked))
    return calibrate(checked, basis)


def _store(store: Store, received: Received, new: Calibrated, coverage_factor: float) -> Receipt:
    """Judged, and everything that the database keeps of an upload, within one transaction."""
    unit = _unit(store, received, new)
    known = store.sessions.by_hash(received.sha256)
    if known is not None:
        return _receipt(known, created=False)
    judged = judge_in_epoch(store, unit, new, coverage_factor)
    record = _record(received, new, judged)
    stand = store.units.stand_key(record.stand)
    store.sessions.add(record, unit, stand, new.checked.session.block, judged.worst)
    keep(store, unit, record, judged, received.at)
    refresh_outlook(store, record.unit)
    flag_verdict(store, Occasion(unit, record.id, received.at), record, judged.decisions, store.fleet.refresh(unit))
    details = {"unit": record.unit, "verdict": record.verdict.value, "revision": record.revision}
    store.log.audit(received.at, received.who, "upload", record.id, details)
    return _receipt(record, created=True)


def _unit(store: Store, received: Received, new: Calibrated) -> int:
    """The unit, stored with its type when this is its first session, and held: rivals wait here."""
    serial = new.checked.session.unit
    if not store.units.exists(serial):
        unit_type = type_of(new.checked, new.calibration)
        store.unit_types.add_once(unit_type, received.at)
        store.units.add_once(serial, unit_type.name, received.simulated)
    return store.units.hold(serial)


def _record(received: Received, new: Calibrated, judged: Judged) -> StoredSession:
    session = new.checked.session
    return StoredSession(
        id=received.sha256[:ID_DIGITS],
        unit=session.unit,
        sha256=received.sha256,
        filename=received.filename,
        size=len(received.content),
        programme=session.programme,
        stand=new.checked.stand,
        operator=session.operator,
        notes=session.notes,
        started_at=new.checked.measured_at,
        uploaded_at=received.at,
        verdict=judged.verdict,
        reason=judged.reason,
        is_reference=judged.is_reference,
        simulated=received.simulated,
        revision=new.model.revision,
        stage=session.stage,
    )


def _receipt(record: StoredSession, *, created: bool) -> Receipt:
    return Receipt(record.id, record.unit, record.verdict, record.reason, created, record.is_reference)
