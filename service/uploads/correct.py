"""Flow: a corrected file is made of a questioned session's, with what would put it right, and stands for it.

Only the slip is corrected: names, dates and everything else of the file stay, and its notes say what was done.
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
from service.kit.arriving_files import Replaced, SentFile
from service.records.reception import Reception
from service.records.supersede import supersede_session
from service.sessions.doubt import Correction, Doubt, Remedies, Remedy, remedies_among
from service.sessions.records import Receipt
from service.sessions.states import RecordState, StateChange
from service.sessions.store import Sessions
from service.storage import Storage
from service.storage.files import LOST
from service.units.store import Units
from service.uploads.receive import deriving, receipt_of, receive

UNKNOWN = "No correction is known for session {id}: upload a corrected file that names it, or accept it."


def correct_session(reception: Reception, id: str, by: str, now: datetime) -> Receipt:
    """Stores the corrected file; ConflictError where the session is not questioned, or where no correction is known."""
    source, found = _doubted(reception.storage, id)
    corrections = tuple(doubt.correction for doubt in found if doubt.correction is not None)
    if not corrections:
        raise ConflictError(say(UNKNOWN, id=id))
    copied = next((d.stands_for for d in found if d.correction is not None and d.correction.unit), None)
    if copied is not None:
        return _as_copy(reception, id, copied, by, now)
    done = joined(", ", (correction.text for correction in corrections))
    content = json.dumps(
        session_document(corrected(source, corrections, say("Corrected: {done}.", done=done)))
    ).encode()
    with reception.storage.database.reading() as store:
        is_check = Sessions(store).get(id).is_check
    replaced = Replaced(id, by, say("corrected: {done}", done=done))
    return receive(reception, SentFile(f"{id}-corrected.json", content, replaces=replaced, is_check=is_check), now)


def remedies_of(storage: Storage, id: str, states: Sequence[StateChange]) -> Remedies:
    """What would put a questioned session right; nothing where nothing is known, or where its file is lost.

    Its life tells what was known when it was questioned. Where it does not, its file is asked.
    """
    if states and states[-1].remedies is not None:
        return states[-1].remedies
    try:
        _, found = _doubted(storage, id)
    except LOST:
        return Remedies()
    return remedies_among(found)


def _as_copy(reception: Reception, id: str, original: str, by: str, now: datetime) -> Receipt:
    """Its readings are stored already under the right serial number: it is superseded by that session."""
    replaced = Replaced(id, by, "corrected: its readings are stored under the right serial number")
    session, _ = supersede_session(reception.storage, deriving(reception, now), replaced, original)
    with reception.storage.database.reading() as store:
        return receipt_of(Sessions(store).get(session.superseded_by or original), created=False)


def _doubted(storage: Storage, id: str) -> tuple[CalibrationSession, tuple[Doubt, ...]]:
    """The session as its file has it, and what is in doubt of it."""
    with storage.database.reading() as store:
        stored = Sessions(store).get(id)
        if stored.state is not RecordState.QUESTIONED:
            raise ConflictError(say("Session {id} is not questioned, so there is nothing to correct.", id=id))
        source = read_upload(storage.files.content(stored.sha256), stored.filename)
        known = known_unit(store, Units(store).key(stored.unit))
        found = doubts(known, as_checked(source, stored.started_at, stored.unit), known.calibration(id), (id,))
    return source, found


def corrected(session: CalibrationSession, corrections: Sequence[Correction], note: str) -> CalibrationSession:
    """The session with readings, their standard errors and nominal scale factors put right; the note says so."""
    readings, errors, sensors = session.readings.copy(), session.standard_errors.copy(), list(session.sensors)
    names = [sensor.name for sensor in sensors]
    for correction in corrections:
        own = [names.index(name) for name in correction.sensors]
        if correction.remedy is Remedy.EXCHANGE:
            readings[:, own], errors[:, own] = readings[:, own[::-1]], errors[:, own[::-1]]
        if correction.remedy in (Remedy.READINGS, Remedy.BOTH):
            readings[:, own] *= correction.factor
            errors[:, own] *= np.abs(correction.factor)
        if correction.remedy in (Remedy.NOMINAL, Remedy.BOTH):
            for i in own:
                sensors[i] = replace(sensors[i], nominal_scale=sensors[i].nominal_scale * correction.factor)
    unit = next((correction.unit for correction in corrections if correction.unit), session.unit)
    notes = f"{session.notes} {note}".strip()
    return replace(session, unit=unit, readings=readings, standard_errors=errors, sensors=tuple(sensors), notes=notes)
