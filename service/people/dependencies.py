"""Dependencies of routes: both stores, with the sender's name in the audit trail."""

from dataclasses import replace
from typing import Annotated

from fastapi import Depends, Form, Path, Request

from service.kit.person import Person
from service.people.admission import PersonOf
from service.storage import Storage
from service.web.application import application_of
from service.web.fields import LongText, Name, Reason, Sought, Text
from service.web.turns import password_turn

CREW = "crew"
"""Default name of an uploader without an account."""


def _storage(request: Request, person: PersonOf) -> Storage:
    return _acting(application_of(request).storage, person)


def _acting(storage: Storage, person: Person) -> Storage:
    """The stores acting for a person, whom the audit trail names."""
    return replace(storage, database=storage.database.acting(person.account))


PasswordTurn = Annotated[None, Depends(password_turn, scope="function")]
"""A turn at hashing passwords, before the database is asked; BusyError where too many wait for one."""
StorageOf = Annotated[Storage, Depends(_storage)]
"""Both stores, for flows that write."""

SEE_OTHER = 303
"""Answer to a form, so that reloading its page sends nothing twice (RFC 9110)."""
Key = Annotated[Sought, Path(min_length=1)]
Number = Annotated[int, Path(ge=1, le=2_000_000_000)]


def _by(person: PersonOf, by: Annotated[Name, Form()]) -> str:
    return person.signs(by)


By = Annotated[str, Depends(_by)]
"""A name: the account's, or as written where there are no accounts."""
FormName = Annotated[Name, Form()]
FormText = Annotated[Text, Form()]
FormLines = Annotated[LongText, Form()]
Why = Annotated[Reason, Form()]
