"""What routes of the API and of the pages ask for by type."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import datetime
from typing import Annotated

from fastapi import Depends, Request

from service.settings import Settings
from service.storage import Storage
from service.storage.store import Store


@dataclass(frozen=True)
class Service:
    """What `create_app` joins and every request can reach, as ``app.state.service``."""

    settings: Settings
    storage: Storage
    clock: Callable[[], datetime]


def _service(request: Request) -> Service:
    service: Service = request.app.state.service
    return service


def _settings(request: Request) -> Settings:
    return _service(request).settings


def _storage(request: Request) -> Storage:
    return _service(request).storage


def _now(request: Request) -> datetime:
    return _service(request).clock()


def _reading(request: Request) -> Iterator[Store]:
    with _service(request).storage.database.reading() as store:
        yield store


SettingsOf = Annotated[Settings, Depends(_settings)]
"""The settings of the service."""
StorageOf = Annotated[Storage, Depends(_storage)]
"""Both stores, for flows that write."""
Now = Annotated[datetime, Depends(_now)]
"""The time of the request, UTC."""
Reading = Annotated[Store, Depends(_reading, scope="function")]
"""The database as one read-only transaction sees it."""
