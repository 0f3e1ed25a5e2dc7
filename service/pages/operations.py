"""State of the service for its operators: is it alive, is it ready, its figures."""

from contextlib import suppress
from typing import Literal

from fastapi import APIRouter, Response
from prometheus_client import CONTENT_TYPE_LATEST
from pydantic import BaseModel, Field

from service.errors import AwayError
from service.jobs.store import Failures
from service.kit.failure import FailedKind
from service.kit.limits import in_force
from service.people.dependencies import StorageOf
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.storage.folders import space_at
from service.web.dependencies import MetricsOf, Now, SettingsOf
from service.web.problem_document import errors

router = APIRouter(tags=["operations"])


class ServiceState(BaseModel):
    """The state of the service."""

    status: str = Field(description="`ok`: it is alive.")


class Readiness(BaseModel):
    """Readiness of the service."""

    status: Literal["ready", "degraded"] = Field(
        description="`ready` when it can do everything, `degraded` when it takes no uploads."
    )
    reasons: list[str] = Field(description="What it cannot do and why; empty when it is ready.")
    failed: dict[FailedKind, int] = Field(
        description="Work beside the requests that has failed, by kind, and waits for the administrator; the service "
        "stays ready with it. `GET /api/v1/jobs/failed` lists it."
    )


@router.get("/healthz")
async def health() -> ServiceState:
    """Liveness: the process answers, however busy it is."""
    return ServiceState(status="ok")


@router.get("/readyz", responses=errors())
def readiness(storage: StorageOf, settings: SettingsOf, now: Now) -> Readiness:
    """Readiness: the database answers, its schema is the one this version needs, and there is room for uploads."""
    storage.database.require_ready()
    with storage.database.reading() as store:
        failed = {kind: number for kind, number in Failures(store).counts(now).items() if number}
    lack = space_at(settings.files, in_force().free).too_little
    reasons = [] if lack is None else [lack]
    return Readiness(status="degraded" if reasons else "ready", reasons=reasons, failed=failed)


@router.get("/metrics", responses={200: {"content": {"text/plain": {}}}, **errors()}, response_class=Response)
def metrics(figures: MetricsOf, settings: SettingsOf, storage: StorageOf, now: Now) -> Response:
    """Figures for Prometheus; without a database those that need none."""
    with suppress(AwayError), storage.database.reading() as store:
        figures.note_pending(WorkQueue(store, WorkKind.DIAGNOSIS).count())
        figures.note_failed(Failures(store).counts(now))
    figures.note_room(space_at(settings.files, in_force().free).free)
    return Response(figures.text(), media_type=CONTENT_TYPE_LATEST)
