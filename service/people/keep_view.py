"""Flow: a view of a list is saved under a name, for oneself or for everybody, or removed."""

from datetime import datetime

from service.errors import ConflictError, ForbiddenError, NotFoundError
from service.kit.person import Person, Role
from service.people.view_store import SavedViews
from service.people.views import NewView, SavedView
from service.storage import Storage
from service.storage.audit import Audit

MAX_VIEWS = 50
"""Views of one list of one person, or shared ones: as many as can be chosen from."""


def may_share(person: Person) -> bool:
    """Whether somebody may save shared views."""
    return person.may(Role.CREW)


def may_remove(view: SavedView, person: Person) -> bool:
    """One's own; shared ones by whoever may share."""
    return may_share(person) if view.shared else view.owner == person.login


def save_view(storage: Storage, new: NewView, person: Person, who: str, now: datetime) -> SavedView:
    """Saves a view; an existing one of the same name is replaced. Without accounts all are shared."""
    owner = "" if new.shared or not person.login else person.login
    if not owner and not may_share(person):
        raise ForbiddenError(
            "Only people who may upload can save views for everybody; sign in and save it for yourself."
        )
    with storage.database.writing() as store:
        existing = SavedViews(store).named(new.page, owner, new.name)
        if existing is None and SavedViews(store).count(new.page, owner) >= MAX_VIEWS:
            raise ConflictError(
                "There are {number} saved views of this list already. Remove one first.", number=MAX_VIEWS
            )
        view = SavedViews(store).put(new.page, owner, new.name, query=new.query, who=who, at=now)
        details = {"view": view.id, "page": view.page, "query": view.query, "shared": view.shared}
        Audit(store).write(now, who, "save view", view.name, details)
        return view


def remove_view(storage: Storage, id: int, person: Person, who: str, now: datetime) -> SavedView:
    """Removes a view; NotFoundError for another person's."""
    with storage.database.writing() as store:
        view = SavedViews(store).get(id)
        if not may_remove(view, person):
            if view.shared:
                raise ForbiddenError("Only people who may upload can remove views that everybody has.")
            raise NotFoundError("There is no saved view {id}.", id=id)
        SavedViews(store).remove(id)
        details = {"view": id, "page": view.page, "query": view.query, "shared": view.shared}
        Audit(store).write(now, who, "remove view", view.name, details)
        return view
