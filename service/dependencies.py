"""What routes of the API and of the pages ask for by type."""

from collections.abc import AsyncIterator, Iterator
from dataclasses import replace
from datetime import datetime
from typing import Annotated

from fastapi import Depends, Request
from starlette.types import Message

from service.admission import PersonOf
from service.application import application_of
from service.background.job_desk import JobDesk
from service.background.read_diagnosis import Reader
from service.background.read_group import GroupReader
from service.errors import TooLargeError
from service.flows.receive import Reception
from service.flows.sign_certificate import Rules
from service.ingest.limits import in_force
from service.languages.language import Language, asked
from service.metrics import Metrics
from service.records.identity import Person
from service.reports.desk import Desk
from service.settings import Settings
from service.storage import Storage
from service.storage.store import Store
from service.views.certificate import laboratory_of

CREW = "crew"
"""Who uploads, where nobody says who they are."""
ENVELOPE = 64 * 1024
"""Bytes that a form may add to its files: for each of 200 a boundary and headers of some 300."""


def _settings(request: Request) -> Settings:
    return application_of(request).settings


def _storage(request: Request, person: PersonOf) -> Storage:
    return _acting(application_of(request).storage, person)


def _acting(storage: Storage, person: Person) -> Storage:
    """The same stores; the audit trail names who acts."""
    return replace(storage, database=storage.database.acting(person.account))


StorageOf = Annotated[Storage, Depends(_storage)]
"""Both stores, for flows that write."""


async def _place(request: Request) -> AsyncIterator[None]:
    """Of a large upload, from before its first byte until it has been worked on."""
    own = application_of(request)
    with own.places.one_for(request.headers.get("content-length", ""), in_force().in_flight):
        yield


def _metrics(request: Request) -> Metrics:
    return application_of(request).metrics


def _now(request: Request) -> datetime:
    return application_of(request).clock()


def _reading(request: Request) -> Iterator[Store]:
    with application_of(request).storage.database.reading() as store:
        yield store


def _summarised(request: Request) -> Iterator[Store]:
    own = application_of(request)
    own.diagnoses.until_summarised()
    with own.storage.database.reading() as store:
        yield store


def _reader(request: Request) -> Reader:
    return application_of(request).diagnoses


def _reception(request: Request, storage: StorageOf, person: PersonOf) -> Reception:
    own = application_of(request)
    k, later = own.settings.coverage_factor, own.settings.diagnosis_workers > 0
    return Reception(storage, k, own.metrics, own.bell.ring, person.signs(CREW), is_dated_later=later)


def _jobs(request: Request) -> JobDesk:
    return application_of(request).jobs


def _groups(request: Request) -> GroupReader:
    return application_of(request).groups


def _desk(request: Request, storage: StorageOf) -> Desk:
    own = application_of(request)
    laboratory = laboratory_of(own.settings)
    return Desk(storage, own.diagnoses.made, laboratory, Rules(own.settings.four_eyes), own.seal, asked(request.scope))


def _language(request: Request) -> Language:
    return asked(request.scope)


LanguageOf = Annotated[Language, Depends(_language)]
"""What is made for people is made in the language of the one who asks."""


def limited(request: Request, most: int, *, is_form: bool) -> Request:
    """The same request, but a body that grows beyond ``most`` bytes is stopped, whatever it announced."""
    longest = most + (ENVELOPE if is_form else 0)
    seen = 0

    async def counted() -> Message:
        nonlocal seen
        message = await request.receive()
        seen += len(message.get("body", b""))
        if seen > longest:
            raise TooLargeError(
                f"An upload may hold {most:,} bytes at a time; this one is larger. Average or split it."
            )
        return message

    return Request(request.scope, counted)


SettingsOf = Annotated[Settings, Depends(_settings)]
"""The settings of the service."""
PlaceOf = Annotated[None, Depends(_place, scope="function")]
"""A place for an upload; BusyError where all are taken."""
MetricsOf = Annotated[Metrics, Depends(_metrics)]
"""The figures of the service."""
ReaderOf = Annotated[Reader, Depends(_reader)]
"""What reads diagnoses."""
GroupReaderOf = Annotated[GroupReader, Depends(_groups)]
"""What reads what groups of sessions show."""
JobDeskOf = Annotated[JobDesk, Depends(_jobs)]
"""Where long work is asked for."""
ReceptionOf = Annotated[Reception, Depends(_reception)]
"""What takes in uploads."""
DeskOf = Annotated[Desk, Depends(_desk)]
"""Where certificates are handed out and signed."""
Now = Annotated[datetime, Depends(_now)]
"""The time of the request, UTC."""
Reading = Annotated[Store, Depends(_reading, scope="function")]
"""The database as one read-only transaction sees it."""
ReadingFleet = Annotated[Store, Depends(_summarised, scope="function")]
"""The same, with what is kept of the fleet as a whole made before, where no process beside the requests makes it."""
