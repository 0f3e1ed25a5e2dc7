"""Flow: a corrected file is derived from a questioned session's, and supersedes it.

Only the mistake is corrected: names, dates and everything else in the file stay, and its notes state the correction.
"""

import json
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime

import numpy as np

from estimator.message import joined, say
from estimator.session import CalibrationSession
from estimator.writing import session_document
from service.errors import ConflictError
from service.ingest import read_upload
from service.ingest.checked import as_checked
from service.judging.plausible import doubts
from service.judging.reference import known_unit
from service.records.reception import Reception
from service.records.supersede import supersede_session
from service.sessions.doubt import Doubt, FileCorrection, Remedies, Remedy, remedies_among
from service.sessions.records import Receipt
from service.sessions.sent import Replaced, SentFile
from service.sessions.states import RecordState, StateChange
from service.sessions.store import Sessions
from service.storage import Files
from service.storage.files import LOST
from service.storage.queries import Store
from service.units.store import Units
from service.uploads.receive import deriving, receipt_of, receive

UNKNOWN = "No correction is known for session {id}: upload a corrected file that names it, or accept it."


def correct_session(reception: Reception, id: str, by: str, now: datetime) -> Receipt:
    """Stores the corrected file; ConflictError where the session is not questioned, or no correction is known."""
    with reception.storage.database.reading() as store:
        source, doubts_found = _doubts_of(store, reception.storage.files, id)
        marks = Sessions(store).get(id).marks
    corrections = tuple(doubt.correction for doubt in doubts_found if doubt.correction is not None)
    if not corrections:
        raise ConflictError(UNKNOWN, id=id)
    original = next((d.stands_for for d in doubts_found if d.correction is not None and d.correction.unit), None)
    if original is not None:
        return _as_copy(reception, id, original, by, now)
    summary = joined(", ", (correction.text for correction in corrections))
    content = json.dumps(
        session_document(corrected(source, corrections, say("Corrected: {done}.", done=summary)))
    ).encode()
    replaced = Replaced(id, by, say("corrected: {done}", done=summary))
    return receive(reception, SentFile(f"{id}-corrected.json", content, replaces=replaced, **marks), now)


def remedies_of(store: Store, files: Files, id: str, states: Sequence[StateChange]) -> Remedies:
    """Corrections of a questioned session; none where nothing is known, or its file is missing.

    Its history has those known when it was questioned; without them its file is examined.
    """
    if states and states[-1].remedies is not None:
        return states[-1].remedies
    try:
        _, doubts_found = _doubts_of(store, files, id)
    except LOST:
        return Remedies()
    return remedies_among(doubts_found)


def _as_copy(reception: Reception, id: str, original: str, by: str, now: datetime) -> Receipt:
    """Supersedes a session whose readings are stored already under the right serial number by that other session."""
    replaced = Replaced(id, by, "corrected: its readings are stored under the right serial number")
    session, _ = supersede_session(reception.storage, deriving(reception, now), replaced, original)
    with reception.storage.database.reading() as store:
        return receipt_of(Sessions(store).get(session.superseded_by or original), created=False)


def _doubts_of(store: Store, files: Files, id: str) -> tuple[CalibrationSession, tuple[Doubt, ...]]:
    """The session in its file, and the doubts about it."""
    stored = Sessions(store).get(id)
    if stored.state is not RecordState.QUESTIONED:
        raise ConflictError("Session {id} is not questioned, so there is nothing to correct.", id=id)
    source = read_upload(files.content(stored.sha256), stored.filename)
    known = known_unit(store, Units(store).key(stored.unit))
    return source, doubts(known, as_checked(source, stored.started_at, stored.unit), known.calibration(id), (id,))


def corrected(session: CalibrationSession, corrections: Sequence[FileCorrection], note: str) -> CalibrationSession:
    """The session with corrected readings, standard errors and nominal scale factors; the note is appended."""
    readings, errors, sensors = session.readings.copy(), session.standard_errors.copy(), list(session.sensors)
    names = [sensor.name for sensor in sensors]
    for correction in corrections:
        indices = [names.index(name) for name in correction.sensors]
        if correction.remedy is Remedy.EXCHANGE:
            readings[:, indices], errors[:, indices] = readings[:, indices[::-1]], errors[:, indices[::-1]]
        if correction.remedy in (Remedy.READINGS, Remedy.BOTH):
            readings[:, indices] *= correction.factor
            errors[:, indices] *= np.abs(correction.factor)
        if correction.remedy in (Remedy.NOMINAL, Remedy.BOTH):
            for i in indices:
                sensors[i] = replace(sensors[i], nominal_scale=sensors[i].nominal_scale * correction.factor)
    unit = next((correction.unit for correction in corrections if correction.unit), session.unit)
    notes = f"{session.notes} {note}".strip()
    return replace(session, unit=unit, readings=readings, standard_errors=errors, sensors=tuple(sensors), notes=notes)
