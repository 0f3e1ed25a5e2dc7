"""Step: calibrations of sessions under a model revision → their rows in the database, beside those of other
revisions.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path

import numpy as np

from estimator.allan import BlockNoise, allan_terms, rests_of
from estimator.errors import SessionError
from estimator.results import Calibration
from estimator.screening.gaps import filled
from estimator.session import IN_SERVICE, Array, CalibrationSession
from service.ingest import read_upload
from service.ingest.checked import as_checked
from service.ingest.stream import open_recording
from service.judging.calibrate import parameter_values
from service.judging.reference import calibration_to_compare_with
from service.sessions.calibrations_store import Calibrations, PackedCalibration, SessionNoises, pack
from service.sessions.history_store import History
from service.sessions.records import ParameterValue, StoredSession
from service.sessions.store import Sessions
from service.settings import VERSION
from service.storage import Storage
from service.storage.files import LOST
from service.storage.queries import Store
from service.units.store import Units


@dataclass(frozen=True, eq=False)
class MadeCalibration:
    """A calibration on its way into the store."""

    calibration: Calibration
    packed: PackedCalibration
    values: tuple[ParameterValue, ...]


def made(calibration: Calibration) -> MadeCalibration:
    """Ready to be kept, with no transaction open."""
    return MadeCalibration(calibration, pack(calibration), parameter_values(calibration))


def keep(store: Store, unit: int, new: Sequence[tuple[StoredSession, MadeCalibration]], at: datetime) -> None:
    """Stores the calibrations and the parameters of the history; decisions on them are derived."""
    Calibrations(store).add([(record, calibrated.packed) for record, calibrated in new], at)
    History(store).add(unit, [(record, calibrated.values) for record, calibrated in new])


MOST = 8_000_000
"""Readings that are held: 64 MB. Of a longer log so many samples in a row are averaged that it fits."""


def keep_noise(storage: Storage, session: str, now: datetime) -> None:
    """Makes it where it is still to be made; averaged sessions hold no rests and keep nothing."""
    with storage.database.reading() as store:
        stored = Sessions(store).get(session)
        if SessionNoises(store).has(session):
            return
    try:
        found = _noise(storage, stored)
    except (*LOST, SessionError):
        return
    if found is None:
        return
    with storage.database.writing() as store:
        unit = Units(store).hold(stored.unit)
        SessionNoises(store).put_once(unit, Sessions(store).get(session), found, VERSION, now)


def _noise(storage: Storage, stored: StoredSession) -> BlockNoise | None:
    """The numerical part, with no transaction open."""
    content = storage.files.content(stored.sha256)
    session = read_upload(content, stored.filename)
    if not session.is_raw and isinstance(content, Path):
        session = thinned(content)
    if not session.is_raw:
        return None
    session = replace(session, readings=filled(session.readings))
    rests = rests_of(session, _reference(storage, stored, session))
    return None if rests is None else allan_terms(rests)


def _reference(storage: Storage, stored: StoredSession, session: CalibrationSession) -> Calibration | None:
    """The unit's calibration that tells a recording in service at rest; None of every other session."""
    if session.programme != IN_SERVICE:
        return None
    with storage.database.reading() as store:
        return calibration_to_compare_with(store, as_checked(session, stored.started_at, stored.unit))


def thinned(path: Path) -> CalibrationSession:
    """A log that is too long to hold, as means over so many samples that it fits; without its labels."""
    recording = open_recording(path)
    head = recording.head
    if head.sample_rate is None:
        return head
    readings, step = _means(recording.chunks, MOST // len(head.sensors))
    bare = replace(head, position=None, time=None, beta=None, flipped=None, temperature=None, directions=None)
    return replace(bare, readings=readings, sample_rate=head.sample_rate / step)


def _means(chunks: Iterator[Array], most: int) -> tuple[Array, int]:
    """(n, m) means over equally many samples, at most ``most`` of them; and over how many."""
    kept: list[Array] = []
    left, step = None, 1
    for chunk in chunks:
        whole = chunk if left is None else np.concatenate([left, chunk])
        count = len(whole) // step
        kept.append(_averaged(whole, step))
        left = whole[count * step :]
        while sum(map(len, kept)) > most:
            joined = np.concatenate(kept)
            kept, spare = [_averaged(joined, 2)], joined[len(joined) // 2 * 2 :]
            left = np.concatenate([np.repeat(spare, step, axis=0), left])
            step *= 2
    return np.concatenate(kept), step


def _averaged(readings: Array, step: int) -> Array:
    count = len(readings) // step
    return np.asarray(readings[: count * step].reshape(count, step, -1).mean(axis=1))
