"""Calibrations as they were computed, one a session and model revision: the whole imu-calibration/1, deflated."""

import json
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache

from sqlalchemy import Select, bindparam, select, update

from estimator.allan.results import TERMS, BlockNoise
from estimator.health.temperature_law import Steps
from estimator.message import say
from estimator.results import Calibration
from service.diagnosis.tables import DiagnosisRow
from service.errors import NotFoundError
from service.queue.records import WorkKind
from service.queue.tables import WorkRow
from service.sessions.decision import Verdict, steps_in
from service.sessions.records import DiagnosisState, DiagnosisSummary, StoredSession
from service.sessions.store import decision_record, session_record, session_rows, worst_columns
from service.sessions.tables import CalibrationRow, DecisionRow, ParameterRow, SessionNoiseRow, SessionRow
from service.storage.json_text import STORED, json_text
from service.storage.queries import Queries, lists

LEVEL = 4
"""Level of deflate: 4 % more bytes than the usual 6, in 40 % of the time; an upload waits for it."""


@dataclass(frozen=True)
class PackedCalibration:
    """A calibration as it is kept."""

    method: str
    document: bytes
    """The whole imu-calibration/1, deflated."""


def pack(calibration: Calibration) -> PackedCalibration:
    """Ready to be stored, so that no transaction waits for it."""
    return PackedCalibration(calibration.method, zlib.compress(json_text(STORED.written(calibration)).encode(), LEVEL))


AT_HAND = 32
"""Calibrations that are kept as they were read: an upload reads its own two or three times, and its reference."""


class Calibrations(Queries):
    """Calibrations by session and model revision."""

    def add(self, new: Sequence[tuple[StoredSession, PackedCalibration]], at: datetime) -> None:
        """Stores new calibrations of sessions under their revisions, with full covariance and residuals; they are
        still to be judged."""
        rows = [
            {
                "session_id": session.id, "revision": session.revision, "method": packed.method,
                "document": packed.document, "computed_at": at, "verdict": Verdict.UNDECIDABLE,
                "reason": session.reason, **worst_columns(None),
            }
            for session, packed in new
        ]  # fmt: skip
        self.insert_many(CalibrationRow, rows)

    def put(self, session: str, revision: int, packed: PackedCalibration) -> None:
        """Stores another calibration in place of the one of a session and revision."""
        conditions = (CalibrationRow.session_id == session, CalibrationRow.revision == revision)
        values = {"method": packed.method, "document": packed.document}
        self._session.execute(update(CalibrationRow).where(*conditions).values(**values))

    def json(self, session: str, revision: int | None = None) -> bytes:
        """imu-calibration/1 of a session, as it was written: the one in force, or the one of a revision."""
        query = _IN_FORCE if revision is None else _UNDER
        deflated = self._session.scalar(query, {"session": session, "under": revision})
        if deflated is None:
            under = "" if revision is None else say(" under model revision {revision}", revision=revision)
            raise NotFoundError(
                "There is no calibration of session {session}{under}.", session=repr(session), under=under
            )
        return zlib.decompress(deflated)

    def with_session(self, id: str) -> tuple[StoredSession, DiagnosisSummary | None, str, Calibration]:
        """A session, its diagnosis in one line where it is made, why the last try to make it failed, and its
        calibration in force; in one query."""
        in_force = (CalibrationRow.session_id == SessionRow.id) & (CalibrationRow.revision == SessionRow.revision)
        line = (DiagnosisRow.state, DiagnosisRow.summary, DiagnosisRow.gain_in_words, WorkRow.failed)
        query = session_rows().add_columns(*line, CalibrationRow.document).join(CalibrationRow, in_force)
        whole = query.outerjoin(WorkRow, (WorkRow.kind == WorkKind.DIAGNOSIS) & (WorkRow.key == SessionRow.id))
        row = self._session.execute(whole.where(SessionRow.id == id)).one_or_none()
        if row is None:
            raise NotFoundError("There is no session {id}.", id=repr(id))
        *session, state, summary, gain, failed, document = row
        made = None if state is None else DiagnosisSummary(DiagnosisState(state), summary, gain or "")
        return session_record(*session), made, failed or "", calibration_of(document)

    def in_force(self, sessions: Iterable[str]) -> dict[str, Calibration]:
        """The calibrations in force of some sessions, in one query."""
        rows = self._session.execute(
            select(CalibrationRow.session_id, CalibrationRow.document)
            .join(SessionRow, SessionRow.id == CalibrationRow.session_id)
            .where(CalibrationRow.revision == SessionRow.revision, SessionRow.id.in_(sessions))
        )
        return {id: calibration_of(document) for id, document in rows}

    def beside_reference(
        self, sessions: Iterable[str], reference: Select[str]
    ) -> tuple[str | None, dict[str, Calibration], dict[str, Steps]]:
        """The reference selected by a query, with the calibrations in force and the corrections for temperature of it
        and of some sessions; in one query.
        """
        listed, against, row = lists("calibrations", "laws"), reference.scalar_subquery(), DecisionRow
        calibrated = (CalibrationRow.session_id == SessionRow.id) & (CalibrationRow.revision == SessionRow.revision)
        decided = (row.session_id == SessionRow.id) & (row.revision == SessionRow.revision)
        rows = self._session.execute(
            select(against, SessionRow.id, CalibrationRow.document, row)
            .select_from(listed)
            .join(SessionRow, SessionRow.id.in_(tuple(sessions)) | (SessionRow.id == against))
            .outerjoin(CalibrationRow, (listed.c.list == "calibrations") & calibrated)
            .outerjoin(row, (listed.c.list == "laws") & decided & row.temperature_correction.is_not(None))
        ).all()
        calibrations = {id: calibration_of(document) for _, id, document, _ in rows if document is not None}
        corrected = [(id, decision_record(decision)) for _, id, _, decision in rows if decision is not None]
        steps = {id: steps_in(tuple(decision for of_id, decision in corrected if of_id == id)) for id in calibrations}
        return rows[0][0] if rows else None, calibrations, steps

    def get(self, session: str, revision: int | None = None) -> Calibration:
        """The calibration of a session, as it was computed."""
        return _read(self.json(session, revision))

    def revisions(self, session: str) -> tuple[int, ...]:
        """The model revisions that a session was computed under, in order."""
        query = select(CalibrationRow.revision).where(CalibrationRow.session_id == session)
        return tuple(self._session.scalars(query.order_by(CalibrationRow.revision)))


_UNDER = select(CalibrationRow.document).where(
    CalibrationRow.session_id == bindparam("session"), CalibrationRow.revision == bindparam("under")
)
_IN_FORCE = (
    select(CalibrationRow.document)
    .join(SessionRow, SessionRow.id == CalibrationRow.session_id)
    .where(CalibrationRow.session_id == bindparam("session"), CalibrationRow.revision == SessionRow.revision)
)


def calibration_of(deflated: bytes) -> Calibration:
    """The calibration of a column."""
    return _read(zlib.decompress(deflated))


@lru_cache(maxsize=AT_HAND)
def _read(document: bytes) -> Calibration:
    """Reads a stored calibration; it is frozen, so that one object serves all readers."""
    return Calibration.from_dict(json.loads(document))


class SessionNoises(Queries):
    """Noise by session; its terms are rows of the history under the model revision in force."""

    def has(self, session: str) -> bool:
        """Whether it was made."""
        return self._session.scalar(select(SessionNoiseRow.session_id).filter_by(session_id=session)) is not None

    def get(self, session: str) -> BlockNoise | None:
        """The noise of a session; None where it holds no rest, or it was not made yet."""
        row = self._session.get(SessionNoiseRow, session)
        return None if row is None else BlockNoise.from_dict(json.loads(zlib.decompress(row.document)))

    def put_once(self, unit: int, record: StoredSession, found: BlockNoise, version: str, at: datetime) -> None:
        """Stores it with its terms, unless somebody else did meanwhile."""
        document = zlib.compress(json_text(STORED.written(found)).encode())
        values = {"document": document, "estimator_version": version, "made_at": at}
        if not self.insert_once(SessionNoiseRow, session_id=record.id, **values):
            return
        key = {"session_id": record.id, "revision": record.revision, "unit_id": unit, "at": record.started_at}
        rows = [
            {
                **key, "sensor": sensor.name, "sensor_index": index, "kind": sensor.kind, "parameter": term.name,
                "value": term.value, "u": term.sigma, "axis_x": None, "axis_y": None, "axis_z": None,
            }
            for index, sensor in enumerate(found.sensors)
            for term in sensor.terms
        ]  # fmt: skip
        self.insert_many(ParameterRow, rows)

    def carry(self, revisions: Mapping[str, int]) -> None:
        """Writes the terms of sessions under another model revision too: noise is the same under all."""
        row = ParameterRow
        conditions = (row.session_id.in_(tuple(revisions)), row.parameter.in_(TERMS))
        known = self._session.scalars(select(row).where(*conditions).order_by(row.revision))
        newest = {(term.session_id, term.sensor, term.parameter): term for term in known}
        columns = [column.name for column in row.__table__.columns]
        rows = [
            {**{name: getattr(term, name) for name in columns}, "revision": revisions[term.session_id]}
            for term in newest.values()
            if term.revision != revisions[term.session_id]
        ]
        self.insert_many(row, rows)
