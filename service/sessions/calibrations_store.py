"""Calibrations as they were computed, one a session and model revision: the whole imu-calibration/1, deflated."""

import json
import zlib
from collections.abc import Iterable, Sequence
from datetime import datetime
from functools import lru_cache

from sqlalchemy import Select, bindparam, select, update

from estimator.message import say
from estimator.results import Calibration
from service.diagnosis.tables import DiagnosisRow
from service.errors import NotFoundError
from service.queue.records import WorkKind
from service.queue.tables import WorkRow
from service.sessions.calibration_document import Packed
from service.sessions.decision import Verdict
from service.sessions.records import DiagnosisState, DiagnosisSummary, StoredSession
from service.sessions.store import session_record, session_rows, worst_columns
from service.sessions.tables import CalibrationRow, SessionRow
from service.storage.queries import Queries

AT_HAND = 32
"""Calibrations that are kept as they were read: an upload reads its own two or three times, and its reference."""


class Calibrations(Queries):
    """Calibrations by session and model revision."""

    def add(self, new: Sequence[tuple[StoredSession, Packed]], at: datetime) -> None:
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

    def put(self, session: str, revision: int, packed: Packed) -> None:
        """Stores another calibration in place of the one of a session and revision."""
        own = (CalibrationRow.session_id == session, CalibrationRow.revision == revision)
        values = {"method": packed.method, "document": packed.document}
        self._session.execute(update(CalibrationRow).where(*own).values(**values))

    def json(self, session: str, revision: int | None = None) -> bytes:
        """imu-calibration/1 of a session, as it was written: the one in force, or the one of a revision."""
        query = _IN_FORCE if revision is None else _UNDER
        deflated = self._session.scalar(query, {"session": session, "under": revision})
        if deflated is None:
            under = "" if revision is None else say(" under model revision {revision}", revision=revision)
            raise NotFoundError(
                say("There is no calibration of session {session}{under}.", session=repr(session), under=under)
            )
        return zlib.decompress(deflated)

    def with_session(self, id: str) -> tuple[StoredSession, DiagnosisSummary | None, str, Calibration]:
        """A session, its diagnosis in one line where it is made, why the last try to make it failed, and its
        calibration in force; in one query."""
        own = (CalibrationRow.session_id == SessionRow.id) & (CalibrationRow.revision == SessionRow.revision)
        line = (DiagnosisRow.state, DiagnosisRow.summary, WorkRow.failed)
        query = session_rows().add_columns(*line, CalibrationRow.document).join(CalibrationRow, own)
        whole = query.outerjoin(WorkRow, (WorkRow.kind == WorkKind.DIAGNOSIS) & (WorkRow.key == SessionRow.id))
        row = self._session.execute(whole.where(SessionRow.id == id)).one_or_none()
        if row is None:
            raise NotFoundError(say("There is no session {id}.", id=repr(id)))
        *session, state, summary, failed, document = row
        made = None if state is None else DiagnosisSummary(DiagnosisState(state), summary)
        return session_record(*session), made, failed or "", _read(zlib.decompress(document))

    def in_force(self, sessions: Iterable[str]) -> dict[str, Calibration]:
        """The calibrations in force of some sessions, in one query."""
        rows = self._session.execute(
            select(CalibrationRow.session_id, CalibrationRow.document)
            .join(SessionRow, SessionRow.id == CalibrationRow.session_id)
            .where(CalibrationRow.revision == SessionRow.revision, SessionRow.id.in_(sessions))
        )
        return {id: _read(zlib.decompress(document)) for id, document in rows}

    def beside_reference(
        self, sessions: Iterable[str], reference: Select[str]
    ) -> tuple[str | None, dict[str, Calibration]]:
        """The reference that a query names, and the calibrations in force of it and of some sessions; in one query."""
        against = reference.scalar_subquery()
        rows = self._session.execute(
            select(against, CalibrationRow.session_id, CalibrationRow.document)
            .join(SessionRow, SessionRow.id == CalibrationRow.session_id)
            .where(CalibrationRow.revision == SessionRow.revision)
            .where(SessionRow.id.in_(tuple(sessions)) | (SessionRow.id == against))
        ).all()
        return rows[0][0] if rows else None, {id: _read(zlib.decompress(document)) for _, id, document in rows}

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


@lru_cache(maxsize=AT_HAND)
def _read(document: bytes) -> Calibration:
    """The calibration that was written; frozen, so that the same one serves whoever reads it."""
    return Calibration.from_dict(json.loads(document))
