"""Calibrations as they were computed, one a session and model revision: the whole imu-calibration/1, deflated."""

import json
import zlib
from collections.abc import Iterable
from datetime import datetime
from functools import lru_cache

from sqlalchemy import select

from estimator.results import Calibration
from service.errors import NotFoundError
from service.records.decision import Judged
from service.storage.calibration_document import calibration_from_dict
from service.storage.queries.base import Queries
from service.storage.queries.sessions import worst_columns
from service.storage.tables import CalibrationRow, SessionRow

AT_HAND = 32
"""Calibrations that are kept as they were read: an upload reads its own two or three times, and its reference."""


class Calibrations(Queries):
    """Calibrations by session and model revision."""

    def put(self, session: str, revision: int, judged: Judged, at: datetime) -> None:
        """Stores the calibration of a session with its full covariance and residuals, and the verdict it led to."""
        document = json.dumps(judged.calibration.to_dict(), separators=(",", ":"), allow_nan=False)
        self._session.merge(
            CalibrationRow(
                session_id=session,
                revision=revision,
                method=judged.calibration.method,
                document=zlib.compress(document.encode()),
                computed_at=at,
                verdict=judged.verdict,
                reason=judged.reason,
                **worst_columns(judged.worst),
            )
        )
        self._session.flush()

    def json(self, session: str, revision: int | None = None) -> bytes:
        """imu-calibration/1 of a session, as it was written: the one in force, or the one of a revision."""
        query = select(CalibrationRow.document).where(CalibrationRow.session_id == session)
        if revision is None:
            query = query.join(SessionRow, SessionRow.id == CalibrationRow.session_id).where(
                CalibrationRow.revision == SessionRow.revision
            )
        else:
            query = query.where(CalibrationRow.revision == revision)
        deflated = self._session.scalar(query)
        if deflated is None:
            under = "" if revision is None else f" under model revision {revision}"
            raise NotFoundError(f"There is no calibration of session {session!r}{under}.")
        return zlib.decompress(deflated)

    def in_force(self, sessions: Iterable[str]) -> dict[str, Calibration]:
        """The calibrations in force of some sessions, in one query."""
        rows = self._session.execute(
            select(CalibrationRow.session_id, CalibrationRow.document)
            .join(SessionRow, SessionRow.id == CalibrationRow.session_id)
            .where(CalibrationRow.revision == SessionRow.revision, SessionRow.id.in_(sessions))
        )
        return {id: _read(zlib.decompress(document)) for id, document in rows}

    def get(self, session: str, revision: int | None = None) -> Calibration:
        """The calibration of a session, as it was computed."""
        return _read(self.json(session, revision))

    def revisions(self, session: str) -> tuple[int, ...]:
        """The model revisions that a session was computed under, in order."""
        query = select(CalibrationRow.revision).where(CalibrationRow.session_id == session)
        return tuple(self._session.scalars(query.order_by(CalibrationRow.revision)))


@lru_cache(maxsize=AT_HAND)
def _read(document: bytes) -> Calibration:
    """The calibration that was written; frozen, so that the same one serves whoever reads it."""
    return calibration_from_dict(json.loads(document))
