"""What those who run the service ask: is it alive, is it ready, what are its figures."""

from fastapi import APIRouter, Response
from prometheus_client import CONTENT_TYPE_LATEST
from pydantic import BaseModel, Field

from service.api.schemas.problem import errors
from service.dependencies import MetricsOf, StorageOf

router = APIRouter(tags=["operations"])


class ServiceState(BaseModel):
    """The state of the service."""

    status: str = Field(description="`ok` when it is alive, `ready` when it can answer.")


@router.get("/healthz")
def health() -> ServiceState:
    """Liveness: the process answers."""
    return ServiceState(status="ok")


@router.get("/readyz", responses=errors())
def readiness(storage: StorageOf) -> ServiceState:
    """Readiness: the database answers and its schema is the one this version needs."""
    storage.database.require_ready()
    return ServiceState(status="ready")


@router.get("/metrics", responses={200: {"content": {"text/plain": {}}}, **errors()}, response_class=Response)
def metrics(figures: MetricsOf) -> Response:
    """Figures for Prometheus."""
    return Response(figures.text(), media_type=CONTENT_TYPE_LATEST)
