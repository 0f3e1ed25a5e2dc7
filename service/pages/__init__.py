"""Pages for people: a frozen context each, made of records by pure functions, and a template.

`mount` joins them to the service. Pages ask the flows; they know nothing of the store's tables.
"""

from functools import cache

from fastapi import APIRouter, FastAPI
from starlette.middleware.gzip import GZipMiddleware

from service.admission import ADMITTED
from service.pages import (
    account_routes,
    admin_routes,
    arrival_routes,
    assets,
    before_routes,
    certificate_routes,
    diagnosis_routes,
    event_routes,
    flag_routes,
    help_routes,
    job_routes,
    layout_routes,
    model_routes,
    oidc_routes,
    paper_routes,
    plan_routes,
    record_routes,
    remark_routes,
    routes,
    saved_routes,
    session_routes,
    stand_routes,
    type_routes,
)
from service.pages.headers import SecurityHeaders
from service.pages.in_language import InOneLanguage
from service.pages.problem import ProblemPages, unexpected_pages

PARTS = (
    routes,
    account_routes,
    admin_routes,
    certificate_routes,
    diagnosis_routes,
    flag_routes,
    saved_routes,
    layout_routes,
    model_routes,
    event_routes,
    record_routes,
    remark_routes,
    paper_routes,
    oidc_routes,
    before_routes,
    plan_routes,
    session_routes,
    stand_routes,
    type_routes,
    arrival_routes,
    help_routes,
    job_routes,
    assets,
)
"""Every file of addresses."""


def mount(app: FastAPI) -> None:
    """Adds the pages, their static files, error pages, compression and the security headers of every answer."""
    app.router.routes.extend(_every().routes)
    unexpected_pages(app)
    app.add_middleware(ProblemPages)
    app.add_middleware(InOneLanguage)
    app.add_middleware(GZipMiddleware, minimum_size=1000, compresslevel=6)
    app.add_middleware(SecurityHeaders)


@cache
def _every() -> APIRouter:
    """The addresses of all pages, built once for all applications."""
    every = APIRouter(dependencies=ADMITTED)
    for part in PARTS:
        every.include_router(part.router)
    return every
