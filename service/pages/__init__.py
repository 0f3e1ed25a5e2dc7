"""Pages for people: a frozen context each, made of records by pure functions, and a template.

`mount` joins them to the service. Pages ask the flows; they know nothing of the store's tables.
"""

from fastapi import FastAPI
from starlette.middleware.gzip import GZipMiddleware

from service.pages import (
    assets,
    diagnosis_routes,
    event_routes,
    flag_routes,
    paper_routes,
    plan_routes,
    record_routes,
    routes,
)
from service.pages.headers import SecurityHeaders
from service.pages.problem import ProblemPages, unexpected_pages


def mount(app: FastAPI) -> None:
    """Adds the pages, their static files, error pages, compression and the security headers of every answer."""
    app.include_router(routes.router)
    app.include_router(diagnosis_routes.router)
    app.include_router(flag_routes.router)
    app.include_router(event_routes.router)
    app.include_router(record_routes.router)
    app.include_router(paper_routes.router)
    app.include_router(plan_routes.router)
    app.include_router(assets.router)
    unexpected_pages(app)
    app.add_middleware(ProblemPages)
    app.add_middleware(GZipMiddleware, minimum_size=1000, compresslevel=6)
    app.add_middleware(SecurityHeaders)
