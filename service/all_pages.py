"""Pages for people: a frozen context each, made of records by pure functions, and a template.

`mount` joins them to the service. Pages ask the flows; they know nothing of the store's tables.
"""

from functools import cache

from fastapi import APIRouter, FastAPI
from starlette.middleware.gzip import GZipMiddleware

from service.diagnosis import pages as diagnoses
from service.flags import pages as flags
from service.models import pages as models
from service.pages import help, routes
from service.pages.due import pages as due
from service.pages.session import list_pages as sessions
from service.pages.stand import pages as stands
from service.pages.type import pages as types
from service.pages.unit import remarks
from service.papers import pages as papers
from service.people import account_pages, admin_pages
from service.people.admission import ADMITTED
from service.people.oidc import pages as oidc_pages
from service.planning import pages as plan_pages
from service.records import pages as records
from service.uploads import arrivals_pages
from service.uploads.layout import pages as layouts
from service.web import assets
from service.web.headers import SecurityHeaders
from service.web.in_language import LanguageHeaders
from service.web.problem_pages import ProblemPages, unexpected_pages
from service.work import pages as work

PARTS = (
    routes, due, account_pages, admin_pages, papers, diagnoses, flags, layouts, models, records,
    remarks, oidc_pages, plan_pages, sessions, stands, types, arrivals_pages, help, work,
    assets,
)  # fmt: skip
"""Modules with routes of pages."""


def mount(app: FastAPI) -> None:
    """Adds the pages, their static files, error pages, compression and the security headers of every answer."""
    app.router.routes.extend(_every().routes)
    unexpected_pages(app)
    app.add_middleware(ProblemPages)
    app.add_middleware(LanguageHeaders)
    app.add_middleware(GZipMiddleware, minimum_size=1000, compresslevel=6)
    app.add_middleware(SecurityHeaders)


@cache
def _every() -> APIRouter:
    every = APIRouter(dependencies=ADMITTED)
    for part in PARTS:
        every.include_router(part.router)
    return every
