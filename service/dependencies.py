"""What routes of the API and of the pages ask for by type."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from datetime import datetime
from typing import Annotated

from fastapi import BackgroundTasks, Depends, Request
from starlette.types import Message

from service.background.diagnose_pending import diagnose_quietly
from service.errors import TooLargeError
from service.flows.diagnose import InProgress, diagnose_now_or_later
from service.flows.receive import Reception
from service.metrics import Metrics
from service.records.diagnosis import StoredDiagnosis
from service.settings import Settings
from service.storage import Storage
from service.storage.store import Store

ENVELOPE = 64 * 1024
"""Bytes that a form may add to its files: for each of 200 a boundary and headers of some 300."""


@dataclass(frozen=True)
class Application:
    """What `create_app` joins and every request can reach, as ``app.state.application``."""

    settings: Settings
    storage: Storage
    clock: Callable[[], datetime]
    diagnosing: InProgress = field(default_factory=InProgress)
    metrics: Metrics = field(default_factory=Metrics)


@dataclass(frozen=True)
class Diagnoser:
    """Diagnoses within the request where that is quick, and after the answer where it is not."""

    application: Application
    after_the_answer: BackgroundTasks

    def of(self, id: str) -> StoredDiagnosis | None:
        """The diagnosis of a session; None while it is being made."""
        application = self.application
        return diagnose_now_or_later(application.storage, id, application.clock(), self.later)

    def later(self, id: str) -> None:
        """Diagnoses a session after the answer."""
        own = self.application
        self.after_the_answer.add_task(diagnose_quietly, own.storage, id, own.clock(), own.diagnosing)


def _application(request: Request) -> Application:
    application: Application = request.app.state.application
    return application


def _settings(request: Request) -> Settings:
    return _application(request).settings


def _storage(request: Request) -> Storage:
    return _application(request).storage


def _metrics(request: Request) -> Metrics:
    return _application(request).metrics


def _now(request: Request) -> datetime:
    return _application(request).clock()


def _reading(request: Request) -> Iterator[Store]:
    with _application(request).storage.database.reading() as store:
        yield store


def _diagnoser(request: Request, after_the_answer: BackgroundTasks) -> Diagnoser:
    return Diagnoser(_application(request), after_the_answer)


def _reception(request: Request, after_the_answer: BackgroundTasks) -> Reception:
    own = _application(request)
    later = Diagnoser(own, after_the_answer).later
    return Reception(own.storage, own.settings.coverage_factor, own.metrics, later)


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
StorageOf = Annotated[Storage, Depends(_storage)]
"""Both stores, for flows that write."""
MetricsOf = Annotated[Metrics, Depends(_metrics)]
"""The figures of the service."""
DiagnoserOf = Annotated[Diagnoser, Depends(_diagnoser)]
"""What makes diagnoses."""
ReceptionOf = Annotated[Reception, Depends(_reception)]
"""What takes in uploads."""
Now = Annotated[datetime, Depends(_now)]
"""The time of the request, UTC."""
Reading = Annotated[Store, Depends(_reading, scope="function")]
"""The database as one read-only transaction sees it."""
