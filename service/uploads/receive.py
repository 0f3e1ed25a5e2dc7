"""Uploaded bytes → checked → calibrated under the model in force → stored, once → derived again.

The one entry of the API and of the pages. The diagnosis is requested within the transaction that stores the session,
and made in the background.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Any

from estimator.errors import Problem, SessionError
from estimator.json_object import Json
from estimator.message import changed, joined, say
from service.errors import RefusedError
from service.ingest import in_turn, look_at, said_as_table
from service.ingest.checked import Checked, check, plain_filename
from service.ingest.digest import content_digest
from service.ingest.layout.envelope import wrap, wrapped
from service.ingest.layout.mapping import fingerprint, layout_of, remembered
from service.jobs.changes import NO_HOOKS, UploadHooks
from service.judging.calibrate import Calibrated, basis_of, calibrate
from service.judging.origin import require_one_origin
from service.judging.plausible import doubts
from service.judging.reference import KnownUnit, known_unit
from service.kit.arriving_files import DEMONSTRATION, Content, where
from service.kit.copying import copied
from service.models.rules import model_for
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.changes import question
from service.records.derive_again import Derived, Deriving, derive_again, foresee_upload
from service.records.follow import follow
from service.records.judge_again import Foreseen
from service.records.keep import MadeCalibration, keep, made
from service.records.reception import Reception
from service.records.register import retired_in_words
from service.records.supersede import give_way, settled_by, supersede
from service.sessions.decision import Verdict
from service.sessions.doubt import remedies_among
from service.sessions.records import ID_DIGITS, Digests, Receipt, StoredSession
from service.sessions.sent import NOTHING_STATED, Received, Replaced, SentFile, Stated
from service.sessions.store import Sessions
from service.storage import Storage
from service.storage.audit import Audit
from service.storage.files import content_hash
from service.storage.landing import Landings
from service.storage.queries import Store
from service.types.design import of_its_design
from service.types.rules import type_of
from service.types.store import UnitTypes
from service.units.store import Register, Units
from service.uploads.store import Layouts, Log

LONGEST_MESSAGE = 1000
"""Characters of a problem that are stored and shown: a hostile file could put megabytes into one."""


def refuse(
    storage: Storage, received: Received, problems: Sequence[Problem], hooks: UploadHooks = NO_HOOKS
) -> RefusedError:
    """Records the refusal and returns the error to raise, with every problem."""
    name, digest = received.filename, received.sha256
    listed = tuple(Problem(_text(p.field), changed(p.message, _text), p.row) for p in problems)
    with storage.database.writing() as store:
        number = Log(store).refusal(received.at, name, digest, received.size, listed)
        Audit(store).write(received.at, received.who, "refuse", digest, {"filename": name, "problems": len(listed)})
        hooks.refused(store, number)
    count = "one problem" if len(listed) == 1 else say("{number} problems", number=len(listed))
    return RefusedError(say("{name} cannot be used: {count}. Nothing was stored.", name=name, count=count), listed)


def _text(message: str) -> str:
    """Printable, for any database and reader."""
    return "".join(c if c.isprintable() else "\ufffd" for c in message)[:LONGEST_MESSAGE]


def receive(reception: Reception, file: SentFile, now: datetime) -> Receipt:
    """Stores a session file with its verdict and counts it; RefusedError for an unusable one."""
    (outcome,) = receive_all(reception, (file,), now)
    if isinstance(outcome, RefusedError):
        raise outcome
    return outcome


def receive_all(reception: Reception, files: Sequence[SentFile], now: datetime) -> tuple[Receipt | RefusedError, ...]:
    """Receives several files; the error of an unusable one is returned."""
    outcomes = tuple(_stored_or_refused(reception, file, now) for file in files)
    for outcome in outcomes:
        if isinstance(outcome, Receipt):
            reception.metrics.count_upload(outcome.verdict.value if outcome.created else "stored-before")
    reception.ring()
    return outcomes


def deriving(reception: Reception, now: datetime) -> Deriving:
    """Settings for deriving what follows from a change."""
    later = reception.is_dated_later
    return Deriving(reception.storage.files, reception.coverage_factor, now, is_dated_later=later)


def _stored_or_refused(reception: Reception, file: SentFile, now: datetime) -> Receipt | RefusedError:
    k = reception.coverage_factor
    try:
        with in_turn(where(file.content)):
            return upload(
                reception.storage, file.content, file.filename, now, coverage_factor=k, who=reception.who,
                stated=file, is_dated_later=reception.is_dated_later, hooks=reception.course,
            )  # fmt: skip
    except RefusedError as refusal:
        return refusal


def upload(
    storage: Storage,
    content: Content,
    filename: str,
    now: datetime,
    *,
    coverage_factor: float = 2.0,
    who: str = "crew",
    stated: Stated = NOTHING_STATED,
    outlook: bool = True,
    is_dated_later: bool = True,
    hooks: UploadHooks = NO_HOOKS,
) -> Receipt:
    """Stores a session file with its calibration and verdict; the same content again gives the same receipt.

    A corrected file names the session that it replaces, of whatever unit or date. Raises RefusedError with every
    problem for an unusable file; then only the refusal is recorded. Without ``outlook`` the unit's dates stay as they
    are: another of its files follows. ``is_dated_later``: they are requested, and made in the background. ``stated``:
    statements of the sender; those of a session that is stored already stay.
    """
    received = Received(len(content), content_hash(content), plain_filename(filename), now, who, **stated.stated())
    derivation = Deriving(storage.files, coverage_factor, now, outlook=outlook, is_dated_later=is_dated_later)
    with storage.database.reading() as store:
        if stated.replaces is not None:
            Sessions(store).get(stated.replaces.session)
        stored = Sessions(store).by_hash(received.sha256)
    if stored is not None:
        storage.files.put_back(content)
        return _known(storage, derivation, stored, stated.replaces)
    try:
        calibrated = _calibrated(storage, _checked(storage, content, received))
    except SessionError as fault:
        problems = said_as_table(where(content), received.filename, fault.problems)
        raise refuse(storage, received, problems, hooks) from fault
    hooks.keeping()
    storage.files.keep(content)
    prepared = _ready(storage, derivation, received, calibrated)
    with storage.database.writing() as store:
        receipt, derived = _store(store, derivation, received, prepared)
        hooks.stored(store, receipt)
    return _with_followups(storage, derivation, receipt, derived)


def _with_followups(
    storage: Storage, derivation: Deriving, receipt: Receipt, derived: Mapping[str, Derived]
) -> Receipt:
    """The receipt after everything that follows was derived."""
    for serial, rest in sorted(derived.items()):
        follow(storage, derivation, serial, rest)
    if not any(rest.is_left for rest in derived.values()):
        return receipt
    with storage.database.reading() as store:
        return replace(receipt_of(Sessions(store).get(receipt.id), created=receipt.created), remark=receipt.remark)


def _known(storage: Storage, derivation: Deriving, stored: StoredSession, replaces: Replaced | None) -> Receipt:
    """The receipt of a session that was stored before, which may now replace the named one."""
    receipt = receipt_of(stored, created=False)
    if replaces is None:
        return receipt
    settled = settled_by(storage, replaces.session, stored.id)
    with storage.database.writing() as store:
        derived = supersede(store, derivation, replaces, Sessions(store).get(stored.id), settled)
    return _with_followups(storage, derivation, receipt, derived)


def _checked(storage: Storage, content: Content, received: Received) -> Checked:
    def is_known(serial: str) -> bool:
        with storage.database.reading() as store:
            return Units(store).exists(serial)

    return check(where(content), received.filename, received.at, is_known)


def _calibrated(storage: Storage, checked: Checked) -> Calibrated:
    """Calibrated under the model in force, with no transaction open; SessionError where the session is insufficient, or
    simulated and its unit is not."""
    with storage.database.reading() as store:
        require_one_origin(store, checked.session)
        new = of_its_design(store, checked)
        basis = basis_of(store, new, model_for(store, new))
    return calibrate(new, basis)


@dataclass(frozen=True, eq=False)
class _Ready:
    new: Calibrated
    digests: Digests
    made: MadeCalibration
    foreseen: Foreseen
    settled: str | None
    """Session from `settled_by`, where its content is stored already."""


def _ready(storage: Storage, derivation: Deriving, received: Received, new: Calibrated) -> _Ready:
    """Computed with no transaction open that others wait for."""
    replaces = received.replaces
    digests = Digests(content_digest(new.checked.session), new.checked.readings_digest)
    with storage.database.reading() as store:
        stored = None if replaces is None else Sessions(store).same(received.sha256, digests.content_digest)
        superseded = None if replaces is None else replaces.session
        foreseen = foresee_upload(store, derivation, _record(received, new), new, superseded)
    settled = None if stored is None or replaces is None else settled_by(storage, replaces.session, stored.id)
    return _Ready(new, digests, made(new.calibration), foreseen, settled)


def _store(store: Store, derivation: Deriving, received: Received, ready: _Ready) -> tuple[Receipt, dict[str, Derived]]:
    """Stores the record and everything that follows from it, in one transaction; returns the rest of the derivation by
    unit."""
    new, replaces = ready.new, received.replaces
    unit = _unit(store, received, new)
    existing = Sessions(store).same(received.sha256, ready.digests.content_digest)
    if existing is not None:
        derived = {} if replaces is None else supersede(store, derivation, replaces, existing, ready.settled)
        return receipt_of(Sessions(store).get(existing.id), created=False), derived
    record = _record(received, new)
    stand = Units(store).stand_key(record.stand)
    Sessions(store).add(record, unit, stand, new.checked.session.block, ready.digests)
    WorkQueue(store, WorkKind.DIAGNOSIS).enqueue_once((record.id,), received.at)
    keep(store, unit, ((record, ready.made),), received.at)
    known = known_unit(store, unit, {record.id: new.calibration}, ready.foreseen.references)
    derived = _derived(derivation, known, record, ready, replaces)
    latest = derived[record.unit].latest
    stored = latest if latest is not None and latest.id == record.id else Sessions(store).get(record.id)
    details = {"unit": stored.unit, "verdict": stored.verdict.value, "revision": stored.revision}
    Audit(store).write(received.at, received.who, "upload", stored.id, details)
    screened = (finding.message for finding in new.calibration.screening)
    remark = joined(" ", filter(None, (retired_in_words(Register(store).get(stored.unit)), *screened)))
    return replace(receipt_of(stored, created=True), remark=remark), derived


def _derived(
    derivation: Deriving, known: KnownUnit, record: StoredSession, ready: _Ready, replaces: Replaced | None
) -> dict[str, Derived]:
    store, shared = known.store, {record.id} | ({replaces.session} if replaces else set())
    doubts_found = doubts(known, ready.new.checked, known.calibration(record.id), shared)
    if doubts_found:
        question(
            store, derivation, record, " ".join(doubt.text for doubt in doubts_found), remedies_among(doubts_found)
        )
    superseded = None if replaces is None else give_way(store, derivation.at, replaces, record)
    since, derived = record.started_at, dict[str, Derived]()
    if superseded is not None and superseded.unit == record.unit:
        since = min(since, superseded.started_at)
    elif superseded is not None:
        derived[superseded.unit] = derive_again(
            store, derivation, superseded.unit, superseded.started_at, (superseded.id,)
        )
    if doubts_found or replaces:
        known = known_unit(store, known.unit, known.made, ready.foreseen.references)
    rest = derive_again(store, derivation, record.unit, since, (record.id,), known=known, foreseen=ready.foreseen)
    return derived | {record.unit: rest}


def _unit(store: Store, received: Received, new: Calibrated) -> int:
    """The unit, locked, stored with its type when this is its first session: concurrent uploads wait here."""
    serial = new.checked.session.unit
    unit, is_demonstration = Units(store).held(serial), received.who == DEMONSTRATION
    if unit is None or not Units(store).exists(serial):
        unit_type, is_simulated = type_of(new.checked), new.checked.session.is_simulated
        UnitTypes(store).add_once(unit_type, received.at)
        Units(store).add_once(serial, unit_type.name, is_simulated)
        Units(store).begin(serial, unit_type.name, is_simulated, is_demonstration=is_demonstration)
        unit = Units(store).hold(serial)
    if require_one_origin(store, new.checked.session):
        Units(store).set_simulated(serial, new.checked.session.is_simulated)
    if not is_demonstration:
        Units(store).set_own(serial)
    return unit


def _record(received: Received, new: Calibrated) -> StoredSession:
    session = new.checked.session
    return StoredSession(
        id=received.sha256[:ID_DIGITS],
        unit=session.unit,
        sha256=received.sha256,
        filename=received.filename,
        size=received.size,
        programme=session.programme,
        stand=new.checked.stand,
        operator=session.operator,
        notes=session.notes,
        started_at=new.checked.measured_at,
        uploaded_at=received.at,
        verdict=Verdict.UNDECIDABLE,
        reason="",
        is_reference=False,
        simulated=session.is_simulated,
        revision=new.model.revision,
        stage=session.stage,
        reservations=None,
        temperature=None if session.temperature is None else float(session.temperature.mean()),
        time_since_power_on=session.time_since_power_on,
        **received.marks,
    )


def receipt_of(record: StoredSession, *, created: bool) -> Receipt:
    """The receipt of a session."""
    return copied(Receipt, record, created=created, remark="")


NO_TABLE = "is given with a session file, which needs none; send it without a mapping"


def receive_mapped(reception: Reception, file: SentFile, mapping: Mapping[str, Any], now: datetime) -> Receipt:
    """Stores the bytes, unchanged, with the mapping; RefusedError where they give no session."""
    complete, layout = _complete(file, mapping)
    with reception.storage.files.arriving() as place:
        receipt = receive(reception, replace(file, content=_wrapped(place, complete, file.content)), now)
    with reception.storage.database.writing() as store:
        unit_type = UnitTypes(store).of_unit(receipt.unit).name
        Layouts(store).remember(layout, unit_type, remembered(complete), who=reception.who, at=now)
    return receipt


def _wrapped(place: Landings, mapping: Mapping[str, Any], content: Content) -> Content:
    """The bytes with their mapping; of a long file in another one."""
    if isinstance(content, bytes):
        return wrapped(mapping, content)
    return place.new().made(lambda file: wrap(mapping, content.path, file))


def _complete(file: SentFile, mapping: Mapping[str, Any]) -> tuple[Json, str]:
    """The mapping with all settings of the parser, so that the file is always read in the same way."""
    try:
        layout_of(mapping, file.filename)
        look = look_at(where(file.content), file.filename, mapping)
    except SessionError as fault:
        raise RefusedError(
            say("{filename} cannot be read by this mapping.", filename=file.filename), fault.problems
        ) from fault
    if look["session"]:
        raise RefusedError(say("{filename} needs no mapping.", filename=file.filename), (Problem("mapping", NO_TABLE),))
    return {**mapping, "table": dict(look["taken"])}, fingerprint(look)
