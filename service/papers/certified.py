"""Everything that is known of one session, and that its certificate states, read from the store."""

from dataclasses import dataclass, replace
from datetime import datetime, timedelta

import numpy as np

from estimator.health.common_motion import CommonMotion
from estimator.results import Calibration, Residuals
from estimator.session import AS_LEFT, CalibrationSession
from service.diagnosis.records import StoredDiagnosis
from service.errors import ConflictError
from service.ingest import read_upload
from service.judging.covered import CoveredTemperatures
from service.judging.reference import covered_at, reference_of
from service.judging.words import verdict_in_words
from service.models.records import Model, ModelRevision
from service.models.rules import in_force, model_of
from service.models.store import Models
from service.papers.found_and_left import FoundAndLeft, found_and_left
from service.papers.records import Laboratory, Traceability
from service.papers.words import traceability
from service.sessions.calibrations_store import Calibrations
from service.sessions.decision import Decision, nominal_factor_of
from service.sessions.history_store import History, HistoryQuery
from service.sessions.records import DiagnosisSummary, HistoryPoint, StoredSession
from service.sessions.states import RecordKind, RecordState, StateChange
from service.sessions.states_store import States
from service.sessions.store import Sessions
from service.sessions.words.conditions import condition_of
from service.settings import VERSION, Settings
from service.stands.records import StandCertificate
from service.stands.store import StandCertificates
from service.storage import Storage
from service.storage.queries import Store
from service.types.records import UnitType
from service.types.store import UnitTypes
from service.units.records import Customer, Service
from service.units.store import Services, Units


@dataclass(frozen=True)
class SessionReport:
    """Everything a session's page or answer shows."""

    session: StoredSession
    calibration: Calibration
    """Calibration computed at upload; `storage` rebuilds it from the stored parts."""
    decisions: tuple[Decision, ...]
    motions: tuple[CommonMotion, ...] = ()
    """Motions common to all sensors since the reference."""
    states: tuple[StateChange, ...] = ()
    """Changes of state since the session was received, oldest first; empty where it was accepted and remained so."""
    diagnosis: DiagnosisSummary | None = None
    """Diagnosis in one line; None while it is still to be made."""
    failed: str = ""
    """Reason why the last attempt at the diagnosis failed; empty where none did."""


def session_report(store: Store, id: str) -> SessionReport:
    """The session, its calibration and its decisions."""
    session, diagnosis, failed, calibration = Calibrations(store).with_session(id)
    decisions, motions = Sessions(store).judged(id)
    states = States(store).of(RecordKind.SESSION, id)
    return SessionReport(session, calibration, decisions, motions, states, diagnosis, failed)


def recent_history(store: Store, serial: str, most: int, wanted: HistoryQuery) -> tuple[HistoryPoint, ...]:
    """The newest sessions of the wanted part of a unit's history, whole, with at most so many points; oldest first."""
    unit = Units(store).key(serial)
    found = History(store).points(unit, replace(wanted, limit=most + 1, newest=True))
    if len(found) <= most:
        return found
    return tuple(point for point in found if point.session != found[0].session)


def traceability_of(store: Store, session: StoredSession) -> Traceability:
    """The traceability by the certificate of the session's stand on the day of measurement, UTC."""
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

    session: str
    """Id."""
    sha256: str
    """SHA-256 of the session's file."""
    started_at: datetime
    model: Model
    """Model of the calibration."""
    calibration: Calibration
    """Calibration without residuals and repeatability, which decide nothing."""
    stand: str | None
    stand_certificate: StandCertificate | None

    @property
    def traceability(self) -> Traceability:
        """Traceability by the certificate of the stand on the day of measurement, UTC."""
        return traceability(self.stand, self.stand_certificate, self.started_at.date())


@dataclass(frozen=True, eq=False)
class StatedSession:
    """Contents of the certificate for programs."""

    report: SessionReport
    source: CalibrationSession
    """The session in the file."""
    type_name: str
    reference: ReferenceSession | None
    """Reference of the session; None for a reference."""
    said: str
    """The verdict with its reservations."""
    finding: str
    """The diagnosis in one line."""
    laboratory: Laboratory
    customer: Customer
    traceability: Traceability
    software: str
    temperatures: CoveredTemperatures | None
    """Temperatures covered by the unit's calibrations up to the session; None where none is stated."""


@dataclass(frozen=True, eq=False)
class CertifiedSession(StatedSession):
    """Everything stated in a certificate. It depends on the session and earlier ones, never on later ones."""

    unit_type: UnitType
    pair: FoundAndLeft | None
    """Pair of a session as left with the session as found; None for any other."""
    diagnosis: StoredDiagnosis
    revisions: tuple[ModelRevision, ...]
    """The accepted causes in its calibration."""
    model: Model
    """Model composed of the revisions."""
    services: tuple[Service, ...]
    """Services of the unit up to the session."""
    history: tuple[HistoryPoint, ...]
    calibration_json: bytes
    """imu-calibration/1 as it was written: the numbers behind the certificate."""


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
            raise ConflictError(NOT_ACCEPTED, state=stored.state)
        until = stored.started_at + JUST_AFTER
        revisions, unit_type = _revisions(store, stored), UnitTypes(store).of_unit(stored.unit)
        return CertifiedSession(
            report=report,
            source=read_upload(storage.files.content(stored.sha256), stored.filename),
            unit_type=unit_type,
            type_name=unit_type.name,
            said=verdict_in_words(condition_of(stored.verdict, is_reference=stored.is_reference), stored.reservations),
            finding=diagnosis.summary,
            reference=_reference(store, stored),
            pair=_pair(store, report),
            diagnosis=diagnosis,
            revisions=in_force(revisions),
            model=_model(revisions, stored),
            services=tuple(s for s in Services(store).of_unit(stored.unit) if s.at < until),
            history=recent_history(store, stored.unit, MOST_POINTS, HistoryQuery(until=until)),
            laboratory=laboratory,
            customer=Units(store).customer(stored.unit),
            traceability=traceability_of(store, stored),
            calibration_json=Calibrations(store).json(id),
            software=VERSION,
            temperatures=covered_at(store, stored),
        )


def _revisions(store: Store, stored: StoredSession) -> tuple[ModelRevision, ...]:
    """The revisions that concern the session, up to that of its calibration."""
    return tuple(r for r in Models(store).of_session(stored.id) if r.id <= stored.revision)


def _model(revisions: tuple[ModelRevision, ...], stored: StoredSession) -> Model:
    return replace(model_of(revisions, stored.started_at), revision=stored.revision)


def _reference(store: Store, stored: StoredSession) -> ReferenceSession | None:
    if stored.is_reference:
        return None
    unit, block = Units(store).key(stored.unit), UnitTypes(store).of_unit(stored.unit).block
    reference_id = reference_of(store, unit, block, stored.programme, stored.started_at).session
    if reference_id is None:
        return None
    session, calibration = Sessions(store).get(reference_id), Calibrations(store).get(reference_id)
    nothing = np.empty((0, 0))
    no_rows = Residuals(value=nothing, sigma=nothing, beta=None, flipped=None, time=None, temperature=None)
    return ReferenceSession(
        session=session.id,
        sha256=session.sha256,
        started_at=session.started_at,
        model=_model(_revisions(store, session), session),
        calibration=replace(calibration, residuals=no_rows, repeatability=nothing),
        stand=session.stand,
        stand_certificate=traceability_of(store, session).certificate,
    )


def _pair(store: Store, report: SessionReport) -> FoundAndLeft | None:
    """The unit as found and as left, for a session as left."""
    stored = report.session
    if stored.stage != AS_LEFT:
        return None
    sessions = (*Sessions(store).before(stored, None, MOST_EARLIER), stored)
    k = nominal_factor_of(report.decisions)
    pair = found_and_left(store, UnitTypes(store).of_unit(stored.unit), sessions, k)
    return pair if pair is not None and pair.left == stored else None
