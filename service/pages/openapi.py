"""The description of the API: problems are described as problem+json."""

from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from service.kit.person import Role
from service.people.access import NEEDED
from service.people.gate import Gate
from service.web.problems import MEDIA_TYPE


def describe(app: FastAPI) -> None:
    """Makes `/openapi.json` say of every error what the service really answers."""

    def description() -> dict[str, Any]:
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
    """As the table of rules writes it, where the route table has a kind of parameter beside its name."""
    return next((route for _, route in NEEDED if route.replace(":path}", "}") == path), path)


def _name_role(operation: dict[str, Any], needed: Role | None, *, is_open: bool) -> None:
    """Who may call it, and what others are told."""
    if needed is None:
        return
    operation["security"] = [{"token": []}, *([{}] if is_open else [])]
    operation["description"] = f"{operation.get('description', '')}\n\nNeeds the role {needed}.".strip()
    problem = {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/ProblemDocument"}}}
    operation["responses"].setdefault("401", {"description": "Nobody signed in.", "content": problem})
    operation["responses"].setdefault("403", {"description": "It is not theirs to do.", "content": problem})


def _name_problems(responses: dict[str, Any]) -> None:
    for status, response in responses.items():
        if status >= "400" and "application/json" in response.get("content", {}):
            response["content"][MEDIA_TYPE] = response["content"].pop("application/json")
