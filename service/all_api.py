"""The description of the API: problems are described as problem+json."""

from functools import cache

from fastapi import APIRouter, FastAPI
from fastapi.openapi.utils import get_openapi

from estimator.json_object import Json
from service.diagnosis import api as diagnoses
from service.flags import api as flags
from service.groups import api as groups
from service.kit.person import Role
from service.models import api as models
from service.outlook import api as feeds
from service.pages import operations
from service.pages.due import api as due
from service.pages.fleet import api as fleet
from service.pages.session import api as sessions
from service.pages.stand import api as stands
from service.pages.type import api as unit_types
from service.pages.unit import api as units
from service.pages.unit import remarks_api as remarks
from service.papers import api as papers
from service.papers.onboard import api as onboard
from service.people import api as people
from service.people.access import NEEDED
from service.people.admission import ADMITTED, Gate
from service.planning import api as plans
from service.records import api as records
from service.records import register_api as register
from service.uploads import api as uploads
from service.web.headers import API
from service.web.held import EntityTags
from service.web.problems import MEDIA_TYPE, add_problem_handlers
from service.work import api as work


def describe(app: FastAPI) -> None:
    """Completes `/openapi.json` with the answers that the service really gives to errors."""

    def description() -> Json:
        if app.openapi_schema is None:
            schema = get_openapi(title=app.title, version=app.version, description=app.description, routes=app.routes)
            is_open = app.state.application.part(Gate).may_be_open
            schema["components"]["securitySchemes"] = {"token": {"type": "http", "scheme": "bearer"}}
            for path, operations in schema["paths"].items():
                for method, operation in operations.items():
                    _name_problems(operation["responses"])
                    _name_role(operation, NEEDED.get((method.upper(), _as_routed(path))), is_open=is_open)
            app.openapi_schema = schema
        return app.openapi_schema

    app.openapi = description  # type: ignore[method-assign]  # FastAPI's documented way


def _as_routed(path: str) -> str:
    """The path as in the table of rules, which states the kind of a parameter beside its name."""
    return next((route for _, route in NEEDED if route.replace(":path}", "}") == path), path)


def _name_role(operation: Json, needed: Role | None, *, is_open: bool) -> None:
    """Adds the role that an operation needs, and its answers to those without it."""
    if needed is None:
        return
    operation["security"] = [{"token": []}, *([{}] if is_open else [])]
    operation["description"] = f"{operation.get('description', '')}\n\nNeeds the role {needed}.".strip()
    problem = {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/ProblemDocument"}}}
    operation["responses"].setdefault("401", {"description": "Nobody signed in.", "content": problem})
    operation["responses"].setdefault("403", {"description": "It is not theirs to do.", "content": problem})


def _name_problems(responses: Json) -> None:
    for status, response in responses.items():
        if status >= "400" and "application/json" in response.get("content", {}):
            response["content"][MEDIA_TYPE] = response["content"].pop("application/json")


PREFIX = API
"""The version of the contract is part of every address."""
ROUTERS = (
    groups.router, remarks.attachments_router, sessions.router, records.router, papers.router, onboard.router,
    papers.printing_router, diagnoses.router, records.events_router, register.router, units.usable_router,
    papers.labels_router, units.router, unit_types.router, models.router, plans.router, stands.router,
    uploads.templates_router, uploads.layouts_router, uploads.router, flags.router,
    remarks.router, flags.webhooks_router, feeds.router, due.router, fleet.router, work.router,
    people.router,
)  # fmt: skip
"""Routers of all resources, in the order in which addresses are tried."""


def mount(app: FastAPI) -> None:
    """Adds every route of the API, its error shape, its description and the tags of its answers to the application."""
    app.router.routes.extend(_every().routes)
    add_problem_handlers(app)
    describe(app)
    app.add_middleware(EntityTags, prefix=PREFIX)


@cache
def _every() -> APIRouter:
    """The routes of all applications: what a route does depends on its request alone, and building them is slow."""
    api, every = APIRouter(prefix=PREFIX), APIRouter(dependencies=ADMITTED)
    for router in ROUTERS:
        api.include_router(router)
    every.include_router(api)
    every.include_router(operations.router)
    return every
