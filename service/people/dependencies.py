"""What routes ask for by type: both stores, for changes in the name of whoever asks."""

from dataclasses import replace
from typing import Annotated

from fastapi import Depends, Form, Path, Request

from service.kit.person import Person
from service.people.admission import PersonOf
from service.storage import Storage
from service.web.application import application_of
from service.web.fields import NO_NUL

CREW = "crew"
"""Who uploads, where nobody says who they are."""


def _storage(request: Request, person: PersonOf) -> Storage:
    return _acting(application_of(request).storage, person)


def _acting(storage: Storage, person: Person) -> Storage:
    """The same stores; the audit trail names who acts."""
    return replace(storage, database=storage.database.acting(person.account))


StorageOf = Annotated[Storage, Depends(_storage)]
"""Both stores, for flows that write."""

SEE_OTHER = 303
"""What a form answers, so that loading its page again sends nothing twice (RFC 9110)."""
SAYS_SOMETHING = r"^[^\x00]*\S[^\x00]*$"

Key = Annotated[str, Path(max_length=200, pattern=r"^[^\x00]+$")]
Number = Annotated[int, Path(ge=1, le=2_000_000_000)]


def _by(person: PersonOf, by: Annotated[str, Form(max_length=200, pattern=SAYS_SOMETHING)]) -> str:
    return person.signs(by)


By = Annotated[str, Depends(_by)]
"""Somebody's name: the account's, or as they wrote it where nobody signs in."""
Perhaps = Annotated[str, Form(max_length=2000, pattern=NO_NUL)]
"""What may be said and need not."""
Why = Annotated[str, Form(max_length=2000, pattern=SAYS_SOMETHING)]
