"""The one place where everything is joined."""

from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from datetime import UTC, datetime
from importlib.metadata import version

from fastapi import FastAPI

from service import api, pages
from service.dependencies import Service
from service.settings import Settings
from service.storage import Database, Files, Storage

DESCRIPTION = (
    "Health of redundant inertial measurement units: calibration sessions in, parameters with uncertainties, "
    "verdicts and histories out. Numbers are SI; every error is application/problem+json."
)


def utc_now() -> datetime:
    """The clock."""
    return datetime.now(UTC)


def create_app(settings: Settings, clock: Callable[[], datetime] = utc_now) -> FastAPI:
    """The service on the database and the folder that the settings name; the schema must be up to date."""
    storage = Storage(Database(settings.database), Files(settings.files))
    app = FastAPI(
        title="imu-health",
        version=version("imu-health"),
        description=DESCRIPTION,
        docs_url=None,
        redoc_url=None,
        lifespan=_closing(storage),
    )
    app.state.service = Service(settings, storage, clock)
    api.mount(app)
    pages.mount(app)
    return app


def _closing(storage: Storage) -> Callable[[FastAPI], AbstractAsyncContextManager[None]]:
    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        yield
        storage.database.close()

    return lifespan
