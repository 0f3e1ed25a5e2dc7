"""What sessions tell of their groups: made once, unless another version of the program failed."""

import json
import zlib
from collections.abc import Collection
from typing import Any

from sqlalchemy import delete, select, update

from estimator.groups import SessionStatistics
from estimator.groups.statistics import FORMAT
from service.storage.group_tables import SessionStatisticsRow
from service.storage.json_text import json_text
from service.storage.queries.base import Queries

MOST_ATTEMPTS = 3
"""Tries at which the program may fail at one session's, or its process die: two could be a machine in need."""
GIVEN_UP = "The program failed at it: a fault of the program, not of the session. The next version tries again."


class Statistics(Queries):
    """Statistics by session."""

    def begin(self, session: str, version: str) -> bool:
        """Whether they are to be made by a version of the program; then this counts as a try."""
        self.insert_once(SessionStatisticsRow, session_id=session, **_begun(version))
        query = select(SessionStatisticsRow).where(SessionStatisticsRow.session_id == session)
        row = self._session.scalars(query.with_for_update()).one()
        if row.format != FORMAT or (row.document is None and row.estimator_version != version):
            self._put(session, **_begun(version))
            row = self._session.scalars(query).one()
        if row.document is not None or row.why:
            return False
        if row.attempts >= MOST_ATTEMPTS:
            self._put(session, why=GIVEN_UP)
            return False
        self._put(session, attempts=row.attempts + 1)
        return True

    def keep(self, session: str, record: SessionStatistics) -> None:
        """Stores what was made."""
        self._put(session, document=zlib.compress(json_text(record.to_dict()).encode()), attempts=0)

    def fail(self, session: str, why: str) -> None:
        """Stores why there are none: this version does not try again."""
        self._put(session, why=why)

    def release(self, session: str) -> None:
        """Nothing was tried: whoever wants them next tries."""
        self._session.execute(delete(SessionStatisticsRow).where(SessionStatisticsRow.session_id == session))
        self._session.expire_all()

    def of(self, sessions: Collection[str]) -> dict[str, SessionStatistics]:
        """What is kept of sessions."""
        query = select(SessionStatisticsRow.session_id, SessionStatisticsRow.document).where(
            SessionStatisticsRow.session_id.in_(tuple(sessions)),
            SessionStatisticsRow.format == FORMAT,
            SessionStatisticsRow.document.is_not(None),
        )
        kept = {id: packed for id, packed in self._session.execute(query) if packed is not None}
        return {id: SessionStatistics.from_dict(json.loads(zlib.decompress(packed))) for id, packed in kept.items()}

    def _put(self, session: str, **values: Any) -> None:
        own = update(SessionStatisticsRow).where(SessionStatisticsRow.session_id == session)
        self._session.execute(own.values(**values))
        self._session.expire_all()


def _begun(version: str) -> dict[str, Any]:
    return {"format": FORMAT, "document": None, "why": "", "attempts": 0, "estimator_version": version}
