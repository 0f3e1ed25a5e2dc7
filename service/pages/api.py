"""The HTTP API, /api/v1: one route file a resource, one shape for every error."""

from functools import cache

from fastapi import APIRouter, FastAPI

from service.flags import api as flags
from service.flags import webhooks_api as webhooks
from service.pages import feeds, operations
from service.pages.certificate import api as papers
from service.pages.diagnosis import api as diagnoses
from service.pages.fleet import api as fleet
from service.pages.group import api as groups
from service.pages.model import api as models
from service.pages.openapi import describe
from service.pages.plan import api as plans
from service.pages.records import api as records
from service.pages.records import events_api as events
from service.pages.session import api as sessions
from service.pages.stand import api as stands
from service.pages.type import api as unit_types
from service.pages.unit import api as units
from service.pages.unit import remarks_api as remarks
from service.pages.uploads import api as uploads
from service.pages.usable import api as usable
from service.papers.onboard import api as onboard
from service.people import api as people
from service.people import view_api as views
from service.people.admission import ADMITTED
from service.web.held import Held
from service.web.prefix import API
from service.web.problems import add_problem_handlers
from service.work import api as work

PREFIX = API
"""The version of the contract is part of every address."""
ROUTERS = (
    groups.router, remarks.attachments_router, sessions.router, records.router, papers.router, onboard.router,
    papers.printing_router, diagnoses.router, events.router, usable.router, papers.labels_router, units.router,
    unit_types.router, models.router, plans.router, stands.router, uploads.templates_router, uploads.layouts_router,
    uploads.router, flags.router, views.router, remarks.router, webhooks.router, feeds.router, fleet.router,
    work.router, people.router,
)  # fmt: skip
"""Of every resource, in the order in which addresses are tried."""


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
    for router in ROUTERS:
        api.include_router(router)
    every.include_router(api)
    every.include_router(operations.router)
    return every
