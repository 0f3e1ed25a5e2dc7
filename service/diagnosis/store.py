"""Diagnoses as they were made, and those still to be made."""

import json
import zlib
from collections.abc import Iterable, Sequence

from sqlalchemy import delete, select, update

from estimator.json_object import Json
from service.diagnosis.records import Diagnosed, StoredDiagnosis
from service.diagnosis.tables import DiagnosisRow
from service.diagnosis.words.diagnosis import NOT_APPLICABLE
from service.kit.copying import copied
from service.sessions.decision import Verdict
from service.sessions.doubt import Reservation
from service.sessions.records import DiagnosisState, DiagnosisSummary
from service.sessions.store import reservations_from_list, reservations_to_list
from service.sessions.tables import SessionRow
from service.storage.queries import Queries


def inapplicable_to_dict(unit: str) -> Json:
    """imu-diagnosis/1 of a session of a programme in which no causes are looked for."""
    empty: Json = {"findings": [], "unexplained": False, "structures": [], "limits": [], "noise": []}
    unmade = dict.fromkeys(("gain", "calibration", "residuals_before"))
    return {"format": "imu-diagnosis/1", "unit": unit, **empty, **unmade, "notes": [NOT_APPLICABLE]}


def read_diagnosis(text: str) -> Diagnosed | None:
    """Reads a stored diagnosis, null as NaN; None for a programme in which no causes are looked for."""
    document = json.loads(text)
    return None if document["gain"] is None else Diagnosed.from_dict(document)


class Diagnoses(Queries):
    """Diagnoses by session."""

    def add_once(self, found: StoredDiagnosis) -> bool:
        """Stores the diagnosis of a session, and returns whether it is new.

        The first one stays, unless another version of the program failed to make it.
        """
        failed = DiagnosisRow.state == DiagnosisState.FAILED
        outdated = DiagnosisRow.estimator_version != found.estimator_version
        self._session.execute(delete(DiagnosisRow).where(DiagnosisRow.session_id == found.session, failed, outdated))
        self._touch(found.session)
        return self.insert_once(
            DiagnosisRow,
            session_id=found.session,
            model_revision=found.model_revision,
            state=found.state,
            summary=found.summary,
            gain_in_words=found.gain_in_words or None,
            document=None if found.document is None else zlib.compress(found.document.encode()),
            verdict_after=found.verdict_after,
            estimator_version=found.estimator_version,
            created_at=found.created_at,
            reservations=reservations_to_list(found.reservations),
        )

    def put_reservations(self, session: str, reservations: Sequence[Reservation]) -> None:
        """Works out a verdict's reservations anew, because the verdict or its model changed."""
        of_session = DiagnosisRow.session_id == session
        written = reservations_to_list(reservations)
        self._touch(session)
        self._session.execute(update(DiagnosisRow).where(of_session).values(reservations=written))
        self._session.expire_all()

    def get(self, session: str) -> StoredDiagnosis | None:
        """The diagnosis of a session; None while it is still to be made."""
        row = self._session.get(DiagnosisRow, session)
        if row is None:
            return None
        document = None if row.document is None else zlib.decompress(row.document).decode()
        return copied(
            StoredDiagnosis,
            row,
            session=row.session_id,
            found=None if document is None else read_diagnosis(document),
            document=document,
            verdict_after=None if row.verdict_after is None else Verdict(row.verdict_after),
            reservations=reservations_from_list(row.session_id, row.reservations) or (),
            gain_in_words=row.gain_in_words or "",
        )

    def with_findings(self, sessions: Iterable[str]) -> dict[str, Diagnosed]:
        """The diagnoses with findings among those of some sessions, in one query."""
        query = select(DiagnosisRow.session_id, DiagnosisRow.document).where(
            DiagnosisRow.session_id.in_(tuple(sessions)),
            DiagnosisRow.state.in_((DiagnosisState.NAMED, DiagnosisState.UNDECIDED)),
            DiagnosisRow.document.is_not(None),
        )
        read = {id: read_diagnosis(zlib.decompress(held).decode()) for id, held in self._session.execute(query) if held}
        return {id: found for id, found in read.items() if found is not None and found.findings}

    def summary(self, session: str) -> DiagnosisSummary | None:
        """The diagnosis of a session in one line; None while it is still to be made."""
        line = (DiagnosisRow.state, DiagnosisRow.summary, DiagnosisRow.gain_in_words)
        row = self._session.execute(select(*line).where(DiagnosisRow.session_id == session)).one_or_none()
        return None if row is None else DiagnosisSummary(DiagnosisState(row[0]), row[1], row[2] or "")

    def has_failed(self, session: str) -> bool:
        """Whether a session could not be diagnosed."""
        found = self.summary(session)
        return found is not None and found.state is DiagnosisState.FAILED

    def _touch(self, session: str) -> None:
        """The unit's verdict may have gained or lost a reservation."""
        unit = self._session.scalar(select(SessionRow.unit_id).where(SessionRow.id == session))
        if unit is not None:
            self.touch(unit)

    def exists(self, session: str) -> bool:
        """Whether a session was diagnosed."""
        return self.summary(session) is not None
