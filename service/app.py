"""The one place where everything is joined."""

from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from datetime import UTC, datetime
from importlib.metadata import version
from threading import Event, Thread

from fastapi import FastAPI
from fastapi.concurrency import run_in_threadpool

from service import api, pages
from service.dependencies import Service
from service.flows.diagnose_pending import diagnose_pending
from service.settings import Settings
from service.storage import Database, Files, Storage

DESCRIPTION = (
    "Health of redundant inertial measurement units: calibration sessions in, parameters with uncertainties, "
    "verdicts and histories out. Numbers are SI; every error is application/problem+json."
)
LAST_DIAGNOSIS = 5.0
"""Seconds that a stopping service waits for the diagnosis at hand; if it takes longer it is made at the next start."""


def utc_now() -> datetime:
    """The clock."""
    return datetime.now(UTC)


def create_app(settings: Settings, clock: Callable[[], datetime] = utc_now) -> FastAPI:
    """The service on the database and the folder that the settings name; the schema must be up to date."""
    service = Service(settings, Storage(Database(settings.database), Files(settings.files)), clock)
    app = FastAPI(
        title="imu-health",
        version=version("imu-health"),
        description=DESCRIPTION,
        docs_url=None,
        redoc_url=None,
        lifespan=_at_work(service),
    )
    app.state.service = service
    api.mount(app, service.metrics)
    pages.mount(app)
    return app


def _at_work(service: Service) -> Callable[[FastAPI], AbstractAsyncContextManager[None]]:
    """From start to stop: pending diagnoses are made beside the requests, and the database is closed at the end."""

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        stop = Event()
        work = (service.storage, service.clock, service.diagnosing, stop)
        pending = Thread(target=diagnose_pending, args=work, name="pending diagnoses", daemon=True)
        pending.start()
        yield
        stop.set()
        await run_in_threadpool(pending.join, LAST_DIAGNOSIS)
        service.storage.database.close()

    return lifespan
