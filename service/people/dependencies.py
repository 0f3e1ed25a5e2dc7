"""What routes ask for by type: both stores, for changes in the name of whoever asks."""

from dataclasses import replace
from typing import Annotated

from fastapi import Depends, Request

from service.kit.person import Person
from service.people.admission import PersonOf
from service.storage import Storage
from service.web.application import application_of

CREW = "crew"
"""Who uploads, where nobody says who they are."""


def _storage(request: Request, person: PersonOf) -> Storage:
    return _acting(application_of(request).storage, person)


def _acting(storage: Storage, person: Person) -> Storage:
    """The same stores; the audit trail names who acts."""
    return replace(storage, database=storage.database.acting(person.account))


StorageOf = Annotated[Storage, Depends(_storage)]
"""Both stores, for flows that write."""
