"""The HTTP API, /api/v1: one route file a resource, one shape for every error."""

from fastapi import APIRouter, FastAPI

from service.api import (
    certificates,
    diagnoses,
    events,
    feeds,
    flags,
    fleet,
    labels,
    models,
    notes,
    operations,
    plans,
    records,
    sessions,
    stands,
    unit_types,
    units,
    usable,
    webhooks,
)
from service.api.openapi import describe
from service.api.problems import add_problem_handlers

PREFIX = "/api/v1"
"""The version of the contract is part of every address."""


def mount(app: FastAPI) -> None:
    """Adds every route of the API, its error shape and its description to the application."""
    api = APIRouter(prefix=PREFIX)
    for resource in (
        sessions, records, certificates, diagnoses, events, usable, labels, units, unit_types, models, plans, stands,
        flags, notes, webhooks, feeds, fleet,
    ):  # fmt: skip
        api.include_router(resource.router)
    app.include_router(api)
    app.include_router(operations.router)
    add_problem_handlers(app)
    describe(app)
