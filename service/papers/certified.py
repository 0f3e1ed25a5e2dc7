"""Everything stated in a certificate of a session, read from the store."""

from dataclasses import dataclass
from datetime import timedelta

from estimator.message import say
from estimator.results import Calibration
from estimator.session import AS_LEFT, CalibrationSession
from service.diagnosis.records import StoredDiagnosis
from service.errors import ConflictError
from service.ingest import read_upload
from service.judging.reference import reference_of
from service.models.records import ModelRevision
from service.models.rules import in_force
from service.models.store import Models
from service.papers.found_and_left import FoundAndLeft, found_and_left
from service.papers.records import Laboratory, Traceability
from service.papers.session_report import SessionReport, recent_history, session_report
from service.papers.words import traceability
from service.sessions.calibrations_store import Calibrations
from service.sessions.decision import nominal_factor_of
from service.sessions.records import HistoryPoint, StoredSession
from service.sessions.states import RecordState
from service.sessions.store import Sessions
from service.settings import VERSION, Settings
from service.stands.store import StandCertificates
from service.storage import Storage
from service.storage.queries import Store
from service.types.records import UnitType
from service.types.store import UnitTypes
from service.units.records import Customer, Service
from service.units.store import Services, Units


def traceability_of(store: Store, session: StoredSession) -> Traceability:
    """By the certificate of its stand at the day of measurement, UTC."""
    day = session.started_at.date()
    certificate = None if session.stand is None else StandCertificates(store).on(session.stand, day)
    return traceability(session.stand, certificate, day)


MOST_POINTS = 10_000
"""Points of the unit's history that are read, of the newest sessions up to the certified one."""
MOST_EARLIER = 50
"""Earlier sessions that are searched for the one as found."""
NOT_ACCEPTED = "This session is {state}: no certificate is issued of a record that does not count."
JUST_AFTER = timedelta(microseconds=1)
"""Resolution of a stored time."""


@dataclass(frozen=True)
class ReferenceSession:
    """The reference of a judged session."""

    session: StoredSession
    calibration: Calibration
    traceability: Traceability


@dataclass(frozen=True)
class CertifiedSession:
    """Everything stated in a certificate. It depends on the session and earlier ones, never on later ones."""

    report: SessionReport
    source: CalibrationSession
    """The session in the file."""
    unit_type: UnitType
    reference: ReferenceSession | None
    """None for a reference."""
    pair: FoundAndLeft | None
    """Of a session as left: with the one as found."""
    diagnosis: StoredDiagnosis
    revisions: tuple[ModelRevision, ...]
    """The accepted causes in its calibration."""
    services: tuple[Service, ...]
    """Of the unit, up to the session."""
    history: tuple[HistoryPoint, ...]
    laboratory: Laboratory
    customer: Customer
    traceability: Traceability
    calibration_json: bytes
    """imu-calibration/1 as it was written: the numbers behind the certificate."""
    software: str
    """Version."""


def laboratory_of(settings: Settings) -> Laboratory:
    """The laboratory from the settings."""
    return Laboratory(
        name=settings.laboratory_name.strip(),
        address=settings.laboratory_address.strip(),
        country=settings.laboratory_country,
        place=settings.laboratory_place.strip(),
    )


def certified_session(storage: Storage, diagnosis: StoredDiagnosis, laboratory: Laboratory) -> CertifiedSession:
    """The session of a diagnosis with everything for its certificate; ConflictError where it does not count."""
    id = diagnosis.session
    with storage.database.reading() as store:
        report = session_report(store, id)
        stored = report.session
        if stored.state is not RecordState.ACCEPTED:
            raise ConflictError(say(NOT_ACCEPTED, state=stored.state))
        until = stored.started_at + JUST_AFTER
        return CertifiedSession(
            report=report,
            source=read_upload(storage.files.content(stored.sha256), stored.filename),
            unit_type=UnitTypes(store).of_unit(stored.unit),
            reference=_reference(store, stored),
            pair=_pair(store, report),
            diagnosis=diagnosis,
            revisions=in_force([r for r in Models(store).of_session(id) if r.id <= stored.revision]),
            services=tuple(s for s in Services(store).of_unit(stored.unit) if s.at < until),
            history=recent_history(store, stored.unit, MOST_POINTS, until=until),
            laboratory=laboratory,
            customer=Units(store).customer(stored.unit),
            traceability=traceability_of(store, stored),
            calibration_json=Calibrations(store).json(id),
            software=VERSION,
        )


def _reference(store: Store, stored: StoredSession) -> ReferenceSession | None:
    """The reference of the session."""
    if stored.is_reference:
        return None
    unit, block = Units(store).key(stored.unit), UnitTypes(store).of_unit(stored.unit).block
    reference_id = reference_of(store, unit, block, stored.programme, stored.started_at).session
    if reference_id is None:
        return None
    session = Sessions(store).get(reference_id)
    return ReferenceSession(session, Calibrations(store).get(reference_id), traceability_of(store, session))


def _pair(store: Store, report: SessionReport) -> FoundAndLeft | None:
    """The unit as found and as left, for a session as left."""
    stored = report.session
    if stored.stage != AS_LEFT:
        return None
    sessions = (*Sessions(store).before(stored, None, MOST_EARLIER), stored)
    k = nominal_factor_of(report.decisions)
    services = Services(store).of_unit(stored.unit)
    pair = found_and_left(store, UnitTypes(store).of_unit(stored.unit), sessions, services, k)
    return pair if pair is not None and pair.left == stored else None
