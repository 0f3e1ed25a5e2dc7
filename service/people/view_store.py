"""Saved views of lists."""

from datetime import datetime

from sqlalchemy import delete, func, select

from service.errors import NotFoundError
from service.people.tables import SavedViewRow
from service.people.views import ListPage, SavedView
from service.storage.queries import Queries


class SavedViews(Queries):
    """Views by list and owner."""

    def of(self, login: str, page: ListPage | None = None) -> tuple[SavedView, ...]:
        """Shared views and a person's own, by name."""
        query = select(SavedViewRow).where(SavedViewRow.owner.in_(("", login)))
        filtered = query if page is None else query.where(SavedViewRow.page == page)
        ordered = filtered.order_by(SavedViewRow.page, func.lower(SavedViewRow.name), SavedViewRow.id)
        return tuple(_view(row) for row in self._session.scalars(ordered))

    def get(self, id: int) -> SavedView:
        """One view."""
        row = self._session.get(SavedViewRow, id)
        if row is None:
            raise NotFoundError("There is no saved view {id}.", id=id)
        return _view(row)

    def named(self, page: ListPage, owner: str, name: str) -> SavedView | None:
        """The view of a name; None where there is none."""
        conditions = (SavedViewRow.page == page, SavedViewRow.owner == owner, SavedViewRow.name == name)
        row = self._session.scalar(select(SavedViewRow).where(*conditions))
        return None if row is None else _view(row)

    def count(self, page: ListPage, owner: str) -> int:
        """Number of an owner's views of a list."""
        conditions = (SavedViewRow.page == page, SavedViewRow.owner == owner)
        return self._session.scalar(select(func.count()).select_from(SavedViewRow).where(*conditions)) or 0

    def put(self, page: ListPage, owner: str, name: str, *, query: str, who: str, at: datetime) -> SavedView:
        """Saves a view; an existing one of that name is replaced."""
        self.insert_once(SavedViewRow, page=page, owner=owner, name=name, query=query, who=who, saved_at=at)
        conditions = (SavedViewRow.page == page, SavedViewRow.owner == owner, SavedViewRow.name == name)
        row = self._session.scalars(select(SavedViewRow).where(*conditions)).one()
        row.query, row.who, row.saved_at = query, who, at
        self._session.flush()
        return _view(row)

    def remove(self, id: int) -> None:
        """Removes a view."""
        self._session.execute(delete(SavedViewRow).where(SavedViewRow.id == id))


def _view(row: SavedViewRow) -> SavedView:
    return SavedView(row.id, ListPage(row.page), row.name, row.owner, row.query, row.who, row.saved_at)
