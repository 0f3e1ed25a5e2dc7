"""Dependencies of routes: settings, clock, database, language, a slot for a large upload."""

from collections.abc import AsyncIterator, Iterator
from datetime import datetime
from typing import Annotated

from fastapi import Depends, Request
from starlette.types import Message

from service.errors import TooLargeError
from service.kit.limits import in_force
from service.kit.metrics import Metrics
from service.languages.language import Language, asked
from service.settings import Settings
from service.storage.queries import Store
from service.web.application import application_of

ENVELOPE = 64 * 1024
"""Bytes that a form may add to its files: for each of 200 a boundary and headers of some 300."""


def _settings(request: Request) -> Settings:
    return application_of(request).settings


async def _slot(request: Request) -> AsyncIterator[None]:
    """Slot of a large upload, from before its first byte until it has been processed."""
    application = application_of(request)
    with application.places.one_for(request.headers.get("content-length", ""), in_force().in_flight):
        yield


def _metrics(request: Request) -> Metrics:
    return application_of(request).metrics


def _now(request: Request) -> datetime:
    return application_of(request).clock()


def _reading(request: Request) -> Iterator[Store]:
    with application_of(request).storage.database.reading() as store:
        yield store


def _language(request: Request) -> Language:
    return asked(request.scope)


LanguageOf = Annotated[Language, Depends(_language)]
"""Language of texts for people."""


def limited(request: Request, limit: int, *, is_form: bool) -> Request:
    """The request with a body limited to ``limit`` bytes, whatever length it announced."""
    limit_in_all = limit + (ENVELOPE if is_form else 0)
    received = 0

    async def counted() -> Message:
        nonlocal received
        message = await request.receive()
        received += len(message.get("body", b""))
        if received > limit_in_all:
            raise TooLargeError(
                "An upload may hold {limit} bytes at a time; this one is larger. Average or split it.",
                limit=f"{limit:,}",
            )
        return message

    return Request(request.scope, counted)


SettingsOf = Annotated[Settings, Depends(_settings)]
UploadSlotOf = Annotated[None, Depends(_slot, scope="function")]
"""A slot for an upload; BusyError where none is free."""
MetricsOf = Annotated[Metrics, Depends(_metrics)]
Now = Annotated[datetime, Depends(_now)]
"""The time of the request, UTC."""
Reading = Annotated[Store, Depends(_reading, scope="function")]
"""A read-only transaction of the database."""
