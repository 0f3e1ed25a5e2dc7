"""Flow: uploaded bytes → checked → calibrated under the model in force → judged → stored, once."""

from dataclasses import dataclass
from datetime import datetime

from estimator.errors import SessionError
from estimator.results import Calibration
from estimator.session import IN_SERVICE, CalibrationSession, comparable
from service.flows.flagging.verdict import flag_verdict
from service.flows.refresh_outlook import refresh_outlook
from service.flows.refuse import refuse
from service.ingest import read_upload
from service.ingest.storable import measured_at, plain_filename, require_storable
from service.judging.in_service import Compared, compared, judge_recording, reference_in_force
from service.judging.judge import judge
from service.judging.model_in_force import calibrated, model_for
from service.judging.parameter_values import parameter_values
from service.judging.tolerances import type_of
from service.records.decision import Judged
from service.records.model import Model
from service.records.session import Receipt, StoredSession
from service.storage import Storage
from service.storage.files import content_hash
from service.storage.store import Store

ID_DIGITS = 20


@dataclass(frozen=True)
class Upload:
    """An upload that can be used: what came, and what the file says."""

    sha256: str
    filename: str
    size: int
    at: datetime
    who: str
    simulated: bool
    session: CalibrationSession
    model: Model
    calibration: Calibration
    recording: Compared | None
    """A recording in service beside its reference; None for every other programme."""


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
    digest = content_hash(content)
    with storage.database.reading() as store:
        known = store.sessions.by_hash(digest)
    if known is not None:
        return _receipt(known, created=False)
    filename = plain_filename(filename)
    try:
        session = read_upload(content, filename)
        require_storable(session, now, filename)
        with storage.database.reading() as store:
            model = model_for(store, session)
            reference = reference_in_force(store, session, now) if session.programme == IN_SERVICE else None
        recording = None if reference is None else compared(session, reference)
        calibration = calibrated(session, model) if recording is None else recording.calibration
    except SessionError as fault:
        raise refuse(storage, content, filename, fault.problems, now, who) from fault
    storage.files.keep(content)
    new = Upload(digest, filename, len(content), now, who, simulated, session, model, calibration, recording)
    with storage.database.writing() as store:
        return _store(store, new, coverage_factor)


def _store(store: Store, new: Upload, coverage_factor: float) -> Receipt:
    """Everything that the database keeps of an upload, within one transaction."""
    unit = _unit(store, new)
    known = store.sessions.by_hash(new.sha256)
    if known is not None:
        return _receipt(known, created=False)
    judged = _judged(store, unit, new, coverage_factor)
    record = _session_record(new, judged)
    stand = store.units.stand_key(record.stand)
    store.sessions.add(record, unit, stand, new.session.block, judged.worst)
    store.calibrations.add(record.id, record.revision, judged, new.at)
    store.history.add(unit, record, parameter_values(new.calibration))
    store.sessions.add_decisions(record.id, judged.decisions, record.revision)
    store.sessions.add_motions(record.id, judged.motions, record.revision)
    refresh_outlook(store, record.unit)
    flag_verdict(store, unit, record, judged.decisions, store.fleet.refresh(unit), new.at)
    details = {"unit": record.unit, "verdict": record.verdict.value, "revision": record.revision}
    store.log.audit(new.at, new.who, "upload", record.id, details)
    return _receipt(record, created=True)


def _unit(store: Store, new: Upload) -> int:
    """The unit, stored with its type when this is its first session, and held: rivals wait here."""
    serial = new.session.unit
    if not store.units.exists(serial):
        unit_type = type_of(new.session, new.calibration)
        store.unit_types.add_once(unit_type, new.at)
        store.units.add_once(serial, unit_type.name, new.simulated)
    return store.units.hold(serial)


def _judged(store: Store, unit: int, new: Upload, coverage_factor: float) -> Judged:
    """The session, judged against the reference of the epoch that it was measured in."""
    if new.recording is not None:
        unit_type = store.unit_types.of_unit(new.session.unit)
        return judge_recording(new.session, new.recording, unit_type, coverage_factor)
    since, until = store.services.around(unit, measured_at(new.session, new.at))
    alike = comparable(new.session.programme)
    reference = store.sessions.reference(unit, new.session.block, since, until, alike)
    return judge(
        new.session,
        new.calibration,
        None if reference is None else store.calibrations.get(reference),
        store.unit_types.of_unit(new.session.unit),
        coverage_factor,
        after_service=since is not None,
    )


def _session_record(new: Upload, judged: Judged) -> StoredSession:
    session = new.session
    return StoredSession(
        id=new.sha256[:ID_DIGITS],
        unit=session.unit,
        sha256=new.sha256,
        filename=new.filename,
        size=new.size,
        programme=session.programme,
        stand=None if session.stand is None else session.stand.id,
        operator=session.operator,
        notes=session.notes,
        started_at=measured_at(session, new.at),
        uploaded_at=new.at,
        verdict=judged.verdict,
        reason=judged.reason,
        is_reference=judged.is_reference,
        simulated=new.simulated,
        revision=new.model.revision,
        stage=session.stage,
    )


def _receipt(record: StoredSession, *, created: bool) -> Receipt:
    return Receipt(record.id, record.unit, record.verdict, record.reason, created, record.is_reference)
