"""One rule for text: no field of any request, page or file takes a control character, and says which one it is."""

from collections.abc import Iterator
from typing import Any

import httpx
import pytest
from fastapi.routing import APIRoute

from service.app import create_app
from service.settings import Settings
from tests.conftest import Holding, SettingsHolding
from tests.service.made_sessions import session_bytes
from tests.serving import http_client

on_postgresql = pytest.mark.parametrize("databases", ["postgresql"], indirect=True)
"""The engine that refuses NUL itself."""
NOWHERE = ("\x00", "a\x00b")
"""Texts that nothing can be looked for by."""
UNTYPED = (*NOWHERE, "a\x0bb", "a\x0cb", "a\x1bb", "a\x85b", "a\u2028b")
APART = frozenset({"password", "old", "new", "secret", "next"})
"""Passwords, which are hashed; the secret of a webhook, which has a pattern of its own; where a browser goes next."""


@pytest.fixture
def client(settings: Settings) -> Iterator[httpx.Client]:
    """An empty service."""
    with http_client(create_app(settings)) as http:
        yield http


def texts_of(schema: dict[str, Any], models: dict[str, Any]) -> bool:
    """Whether a value may be any text."""
    schemas = [models[s["$ref"].rsplit("/", 1)[1]] if "$ref" in s else s for s in schema.get("anyOf", [schema])]
    return any(s.get("type") == "string" and not {"enum", "const", "format"} & set(s) for s in schemas)


def code(text: str) -> str:
    """The first control character, as messages name it."""
    return next(f"U+{ord(c):04X}" for c in text if not c.isprintable())


@on_postgresql
def test_every_text_of_every_call_is_refused_under_its_name(client: httpx.Client) -> None:
    described, asked = client.get("/openapi.json").json(), 0
    models = described["components"]["schemas"]
    for path, operations in described["paths"].items():
        for method, operation in operations.items():
            body = operation.get("requestBody", {}).get("content", {}).get("application/json", {}).get("schema", {})
            model = models.get(body.get("$ref", "").rsplit("/", 1)[-1], {})
            for name, schema in model.get("properties", {}).items():
                if texts_of(schema, models) and name not in APART:
                    asked += 1
                    for text in UNTYPED:
                        answer = client.request(method, path.replace("{id}", "1"), json={name: text})
                        assert code(text) in faults(answer)[name] or name == "url", (method, path, name, text)
    assert asked > 60


def faults(answer: httpx.Response) -> dict[str, str]:
    """Problems that an answer names, by field."""
    assert answer.status_code == 422, answer.text
    return {fault["field"]: fault["message"] for fault in answer.json()["problems"]}


@on_postgresql
def test_nothing_is_looked_for_by_a_text_that_is_none(client: httpx.Client) -> None:
    described = client.get("/openapi.json").json()
    for path, operations in described["paths"].items():
        for method, operation in operations.items():
            for parameter in operation.get("parameters", []):
                if texts_of(parameter["schema"], described["components"]["schemas"]):
                    for text in NOWHERE:
                        is_in_path = parameter["in"] == "path"
                        name = parameter["name"]
                        where = path.replace(f"{{{name}}}", "%00") if is_in_path else path
                        answer = client.request(method, where, params=None if is_in_path else {name: text})
                        assert answer.status_code in (404, 422), (method, path, name)


@on_postgresql
def test_every_text_of_every_form_is_refused_under_its_name(settings: Settings) -> None:
    app = create_app(settings)
    forms = {route.path: list(texts_in(route.dependant)) for route in every_route(app.routes)}
    with http_client(app) as client:
        for path, names in forms.items():
            for name in set(names) - APART:
                for text in NOWHERE if name == "login" else UNTYPED:
                    answer = client.post(path.replace("{id}", "1"), data={name: text})
                    assert (answer.status_code, code(text) in answer.text) == (422, True), (path, name, text)
    assert sum(map(len, forms.values())) > 60


def every_route(routes: list[Any]) -> Iterator[APIRoute]:
    """The routes that take forms, out of nested routers."""
    for route in routes:
        router = getattr(route, "original_router", None)
        if router is not None:
            yield from every_route(router.routes)
        elif isinstance(route, APIRoute) and "POST" in route.methods and not route.include_in_schema:
            yield route


def texts_in(dependant: Any) -> Iterator[str]:
    """Names of fields that may be any text."""
    for parameter in dependant.body_params:
        if parameter.field_info.annotation is str:
            yield parameter.alias
    for inner in dependant.dependencies:
        yield from texts_in(inner)


@pytest.fixture
def measured(holding: Holding) -> httpx.Client:
    """A service with a session of one unit."""
    return holding(session_bytes())


@on_postgresql
@pytest.mark.parametrize("text", UNTYPED)
def test_forms_with_files_and_files_themselves_are_held_to_it(measured: httpx.Client, text: str) -> None:
    attached = measured.post("/api/v1/attachments", data={"unit": "BA-017", "text": text, "by": "K. Ito"},
                             files={"file": ("a.txt", b"a")})  # fmt: skip
    assert code(text) in faults(attached)["text"]
    mapped = measured.post("/upload/layout", data={"fact.unit": text}, files={"file": ("a.csv", b"a,b\n1,2\n")})
    assert (mapped.status_code, code(text) in mapped.text) == (422, True)
    replaced = measured.post("/api/v1/sessions", files={"file": ("a.json", session_bytes(seed=2))},
                             data={"supersedes": "a", "by": "K. Ito", "why": text})  # fmt: skip
    assert code(text) in faults(replaced)["why"]
    for field in ("notes", "operator"):
        refused = measured.post("/api/v1/sessions", content=session_bytes(seed=2, **{field: text}))
        assert "control character" in faults(refused)[field]
    register = f"serial,unit_type,note\nBA-018,hex,{text}\n".encode()
    table = measured.post("/api/v1/register", data={"by": "K. Ito"}, files={"file": ("a.csv", register)})
    assert code(text) in faults(table)["note"]


@on_postgresql
def test_lines_of_a_reason_end_as_on_any_machine(measured: httpx.Client) -> None:
    said = measured.post("/api/v1/units/BA-017/notes", json={"text": "warm\r\nroom\rat\tnoon\n", "by": "K. Ito"})
    assert said.json()["text"] == "warm\nroom\nat\tnoon\n"


@on_postgresql
def test_what_an_earlier_release_stored_is_still_found(settings_holding: SettingsHolding) -> None:
    with http_client(create_app(settings_holding(session_bytes()))) as client:
        for path in ("/api/v1/units", "/api/v1/sessions", "/api/v1/flags", "/"):
            assert client.get(path, params={"stand": "a\x0bb", "q": "a\tb"}).status_code == 200
