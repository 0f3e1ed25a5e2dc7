"""What the rests of sessions say of noise: made once, kept beside the calibration, never judged."""

import json
import zlib
from collections.abc import Mapping
from datetime import datetime

from sqlalchemy import select

from estimator.allan.results import TERMS, BlockNoise
from service.sessions.records import StoredSession
from service.sessions.tables import ParameterRow, SessionNoiseRow
from service.storage.documents import STORED
from service.storage.json_text import json_text
from service.storage.queries import Queries


class Noises(Queries):
    """Noise by session; its terms are rows of the history under the model revision in force."""

    def has(self, session: str) -> bool:
        """Whether it was made."""
        return self._session.scalar(select(SessionNoiseRow.session_id).filter_by(session_id=session)) is not None

    def get(self, session: str) -> BlockNoise | None:
        """Of a session; None where it holds no rest, or it was not made yet."""
        row = self._session.get(SessionNoiseRow, session)
        return None if row is None else BlockNoise.from_dict(json.loads(zlib.decompress(row.document)))

    def put_once(self, unit: int, record: StoredSession, found: BlockNoise, version: str, at: datetime) -> None:
        """Stores it with its terms, unless somebody else did meanwhile."""
        document = zlib.compress(json_text(STORED.written(found)).encode())
        values = {"document": document, "estimator_version": version, "made_at": at}
        if not self.insert_once(SessionNoiseRow, session_id=record.id, **values):
            return
        own = {"session_id": record.id, "revision": record.revision, "unit_id": unit, "at": record.started_at}
        rows = [
            {
                **own, "sensor": sensor.name, "sensor_index": index, "kind": sensor.kind, "parameter": term.name,
                "value": term.value, "u": term.sigma, "axis_x": None, "axis_y": None, "axis_z": None,
            }
            for index, sensor in enumerate(found.sensors)
            for term in sensor.terms
        ]  # fmt: skip
        self.insert_many(ParameterRow, rows)

    def carry(self, revisions: Mapping[str, int]) -> None:
        """Writes the terms of sessions under another model revision too: noise is the same under all."""
        row = ParameterRow
        own = (row.session_id.in_(tuple(revisions)), row.parameter.in_(TERMS))
        known = self._session.scalars(select(row).where(*own).order_by(row.revision))
        newest = {(one.session_id, one.sensor, one.parameter): one for one in known}
        columns = [column.name for column in row.__table__.columns]
        rows = [
            {**{name: getattr(one, name) for name in columns}, "revision": revisions[one.session_id]}
            for one in newest.values()
            if one.revision != revisions[one.session_id]
        ]
        self.insert_many(row, rows)
