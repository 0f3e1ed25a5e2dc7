"""Calibrations as they were computed: the whole imu-calibration/1, deflated."""

import json
import zlib

from sqlalchemy import select

from estimator.results import Calibration
from service.errors import NotFoundError
from service.storage.calibration_document import calibration_from_dict
from service.storage.queries.base import Queries
from service.storage.tables import CalibrationRow


class Calibrations(Queries):
    """Calibrations by session."""

    def add(self, session: str, calibration: Calibration) -> None:
        """Stores the calibration of a session with its full covariance and residuals."""
        document = json.dumps(calibration.to_dict(), separators=(",", ":"), allow_nan=False)
        self._session.add(
            CalibrationRow(session_id=session, method=calibration.method, document=zlib.compress(document.encode()))
        )
        self._session.flush()

    def json(self, session: str) -> bytes:
        """imu-calibration/1 of a session, as it was written."""
        deflated = self._session.scalar(select(CalibrationRow.document).where(CalibrationRow.session_id == session))
        if deflated is None:
            raise NotFoundError(f"There is no calibration of session {session!r}.")
        return zlib.decompress(deflated)

    def get(self, session: str) -> Calibration:
        """The calibration of a session, as it was computed."""
        return calibration_from_dict(json.loads(self.json(session)))
