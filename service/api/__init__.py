"""The HTTP API, /api/v1: one route file a resource, one shape for every error."""

from functools import cache

from fastapi import APIRouter, FastAPI

from service.admission import ADMITTED
from service.api import (
    attachments,
    certificates,
    diagnoses,
    events,
    feeds,
    flags,
    fleet,
    groups,
    identity,
    jobs,
    labels,
    layouts,
    models,
    notes,
    operations,
    plans,
    printing,
    records,
    sessions,
    stands,
    templates,
    unit_types,
    units,
    uploads,
    usable,
    views,
    webhooks,
)
from service.api.held import Held
from service.api.openapi import describe
from service.api.problems import add_problem_handlers
from service.identity.access import API

PREFIX = API
"""The version of the contract is part of every address."""


def mount(app: FastAPI) -> None:
    """Adds every route of the API, its error shape, its description and the tags of its answers to the application."""
    app.router.routes.extend(_every().routes)
    add_problem_handlers(app)
    describe(app)
    app.add_middleware(Held, prefix=PREFIX)


@cache
def _every() -> APIRouter:
    """The routes of all applications: what a route does depends on its request alone, and building them is slow."""
    api, every = APIRouter(prefix=PREFIX), APIRouter(dependencies=ADMITTED)
    for resource in (
        groups, attachments, sessions, records, certificates, printing, diagnoses, events, usable, labels, units,
        unit_types, models, plans, stands, templates, layouts, uploads, flags, views, notes, webhooks, feeds, fleet,
        jobs, identity,
    ):  # fmt: skip
        api.include_router(resource.router)
    every.include_router(api)
    every.include_router(operations.router)
    return every
