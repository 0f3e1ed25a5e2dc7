"""What routes of the API and of the pages ask for by type."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from datetime import datetime
from typing import Annotated

from fastapi import BackgroundTasks, Depends, Request
from starlette.types import Message

from service.background.diagnose_pending import diagnose_quietly
from service.errors import ServiceError, TooLargeError
from service.flows.diagnose import InProgress, diagnose_now_or_later
from service.log import log
from service.metrics import Metrics
from service.records.diagnosis import StoredDiagnosis
from service.settings import Settings
from service.storage import Storage
from service.storage.store import Store


@dataclass(frozen=True)
class Service:
    """What `create_app` joins and every request can reach, as ``app.state.service``."""

    settings: Settings
    storage: Storage
    clock: Callable[[], datetime]
    diagnosing: InProgress = field(default_factory=InProgress)
    metrics: Metrics = field(default_factory=Metrics)


@dataclass(frozen=True)
class Diagnoser:
    """Diagnoses within the request where that is quick, and after the answer where it is not."""

    service: Service
    after_the_answer: BackgroundTasks

    def of(self, id: str, *, wait: bool = True) -> StoredDiagnosis | None:
        """The diagnosis of a session; None while it is being made."""
        service = self.service
        return diagnose_now_or_later(service.storage, id, service.clock(), self._later, wait=wait)

    def after_upload(self, id: str, *, wait: bool = True) -> None:
        """The same for a session that was just stored: whatever hinders it leaves the diagnosis pending."""
        try:
            self.of(id, wait=wait)
        except ServiceError as fault:
            log.warning("diagnosis pending", session=id, reason=str(fault))

    def _later(self, id: str) -> None:
        service = self.service
        self.after_the_answer.add_task(diagnose_quietly, service.storage, id, service.clock(), service.diagnosing)


def _service(request: Request) -> Service:
    service: Service = request.app.state.service
    return service


def _settings(request: Request) -> Settings:
    return _service(request).settings


def _storage(request: Request) -> Storage:
    return _service(request).storage


def _metrics(request: Request) -> Metrics:
    return _service(request).metrics


def _now(request: Request) -> datetime:
    return _service(request).clock()


def _reading(request: Request) -> Iterator[Store]:
    with _service(request).storage.database.reading() as store:
        yield store


def _diagnoser(request: Request, after_the_answer: BackgroundTasks) -> Diagnoser:
    return Diagnoser(_service(request), after_the_answer)


def limited(request: Request, most: int, envelope: int) -> Request:
    """The same request, but a body that grows beyond ``most`` and its envelope is stopped, whatever it announced."""
    seen = 0

    async def counted() -> Message:
        nonlocal seen
        message = await request.receive()
        seen += len(message.get("body", b""))
        if seen > most + envelope:
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
Now = Annotated[datetime, Depends(_now)]
"""The time of the request, UTC."""
Reading = Annotated[Store, Depends(_reading, scope="function")]
"""The database as one read-only transaction sees it."""
