"""Flow: a view of a list is kept under a name, for oneself or for everybody, or removed."""

from datetime import datetime

from service.errors import ConflictError, ForbiddenError, NotFoundError
from service.records.identity import Person, Role
from service.records.saved_view import NewView, SavedView
from service.storage import Storage

MOST = 50
"""Views of one list that one person, or everybody together, has: as many as still can be chosen from."""


def may_share(person: Person) -> bool:
    """Whether somebody may keep views that everybody has."""
    return person.may(Role.CREW)


def may_remove(view: SavedView, person: Person) -> bool:
    """One's own; of those that everybody has, whoever may share them."""
    return may_share(person) if view.shared else view.owner == person.login


def save_view(storage: Storage, new: NewView, person: Person, who: str, now: datetime) -> SavedView:
    """Keeps a view; under a name that is there already it replaces the other. Where nobody signs in, all are shared."""
    owner = "" if new.shared or not person.login else person.login
    if not owner and not may_share(person):
        raise ForbiddenError("Only who may upload keeps views for everybody; keep it for yourself, signed in.")
    with storage.database.writing() as store:
        known = store.saved_views.named(new.page, owner, new.name)
        if known is None and store.saved_views.count(new.page, owner) >= MOST:
            raise ConflictError(f"There are {MOST} saved views of this list already. Remove one first.")
        view = store.saved_views.put(new.page, owner, new.name, query=new.query, who=who, at=now)
        details = {"view": view.id, "page": view.page, "query": view.query, "shared": view.shared}
        store.audit.write(now, who, "save view", view.name, details)
        return view


def remove_view(storage: Storage, id: int, person: Person, who: str, now: datetime) -> SavedView:
    """Removes a view; NotFoundError for another person's own, which nobody else knows of."""
    with storage.database.writing() as store:
        view = store.saved_views.get(id)
        if not may_remove(view, person):
            if view.shared:
                raise ForbiddenError("Only who may upload removes views that everybody has.")
            raise NotFoundError(f"There is no saved view {id}.")
        store.saved_views.remove(id)
        details = {"view": id, "page": view.page, "query": view.query, "shared": view.shared}
        store.audit.write(now, who, "remove view", view.name, details)
        return view
