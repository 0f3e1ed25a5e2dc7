"""People's own layouts of tables, and how each is read."""

from collections.abc import Mapping
from datetime import datetime
from typing import Any

from sqlalchemy import select

from service.storage.layout_tables import LayoutRow
from service.storage.queries.base import Queries


class Layouts(Queries):
    """Mappings by the fingerprint of the headings; the last one holds."""

    def remember(self, fingerprint: str, unit_type: str, mapping: Mapping[str, Any], *, who: str, at: datetime) -> None:
        """Stores how files of a layout were read, unless that is known already."""
        if self.find(fingerprint, unit_type, only=True) != mapping:
            own = {"fingerprint": fingerprint, "unit_type": unit_type, "mapping": dict(mapping)}
            self._session.add(LayoutRow(**own, who=who, remembered_at=at))
            self._session.flush()

    def find(self, fingerprint: str, unit_type: str = "", *, only: bool = False) -> dict[str, Any] | None:
        """The mapping for units of a type, or else unless ``only`` for that type's, the last one of any."""
        query = select(LayoutRow.mapping).where(LayoutRow.fingerprint == fingerprint)
        own = query.where(LayoutRow.unit_type == unit_type).order_by(LayoutRow.id.desc()).limit(1)
        found = self._session.scalar(own)
        if found is None and not only and not unit_type:
            found = self._session.scalar(query.order_by(LayoutRow.id.desc()).limit(1))
        return found
