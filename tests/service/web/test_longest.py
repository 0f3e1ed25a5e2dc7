"""Every text at its longest: whatever is put together from them fits its column, on both engines."""

import json
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from random import Random
from typing import Any

import httpx
import pytest

from service.app import create_app
from service.kit.person import COMMAND_LINE, Role
from service.people.changes import add_account, make_token
from service.settings import Settings
from tests.databases import all_on_both_engines as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import session_bytes
from tests.serving import http_client
from tests.stock import stores

LOGIN, TEXT = 60, 200
NOW = datetime.now(UTC)


def longest(length: int, seed: int = 1) -> str:
    """Characters of four bytes each, which no engine packs."""
    return "".join(chr(Random(seed + k).randint(0x20000, 0x2A6DF)) for k in range(length))


SERIAL, KIND, STAND = (longest(TEXT, seed) for seed in (1000, 2000, 3000))
SENSORS = [longest(TEXT, 4000 + 1000 * k) for k in range(6)]


def session(seed: int, **changes: Any) -> bytes:
    """A session whose every name is as long as it may be."""
    document = json.loads(session_bytes(seed=seed, month=seed, unit=SERIAL, **changes))
    columns = [sensor["name"] for sensor in document["sensors"]]
    for sensor, column, name in zip(document["sensors"], columns, SENSORS, strict=True):
        sensor["name"] = name
        for end in ("", "_se"):
            document["table"][name + end] = document["table"].pop(column + end)
    document["stand"]["id"] = STAND
    texts = {"unit_type": KIND, "operator": longest(TEXT), "notes": longest(2000)}
    return json.dumps(document | texts).encode()


@pytest.fixture
def program(settings: Settings) -> Iterator[httpx.Client]:
    """A program whose account and token have names as long as they may be."""
    login = LOGIN * "a"
    with stores(settings) as storage:
        add_account(storage, login, longest(TEXT), Role.ADMIN, NOW, who=COMMAND_LINE)
        _, secret = make_token(
            storage, login, longest(TEXT), Role.ADMIN, NOW, lifetime=timedelta(days=1), who=COMMAND_LINE
        )
    with http_client(create_app(settings)) as client:
        client.headers["Authorization"] = f"Bearer {secret}"
        yield client


def test_every_text_at_its_longest_is_kept(program: httpx.Client) -> None:
    for number, moved in ((1, 0.0), (2, 90.0)):
        stored = program.post("/api/v1/sessions", content=session(number, a3_moved=moved))
        assert stored.status_code == 201, stored.text
    described = program.get("/openapi.json").json()
    place = {"serial": SERIAL, "name": KIND, "id": stored.json()["id"], "login": LOGIN * "a", "number": "1"}
    answered = set[int]()
    for path, operations in described["paths"].items():
        for method, operation in operations.items():
            body = operation.get("requestBody", {}).get("content", {}).get("application/json", {}).get("schema", {})
            if "$ref" not in body:
                continue
            model = described["components"]["schemas"][body["$ref"].rsplit("/", 1)[1]]
            where = path
            for name, value in place.items():
                is_number = name == "id" and not path.startswith("/api/v1/sessions")
                where = where.replace(f"{{{name}}}", "1" if is_number else STAND if "/stands/" in path else value)
            answer = program.request(method, where, json=filled(model))
            assert answer.status_code < 500, (method, path, answer.text)
            answered.add(answer.status_code)
    assert answered >= {200, 201}
    for path in (
        "",
        "audit",
        "audit/check",
        "flags",
        "units",
        "sessions",
        "stands",
        "unit-types",
        "models",
        "register",
    ):
        assert program.get(f"/api/v1/{path}" if path else "/").status_code == 200


def filled(model: dict[str, Any]) -> dict[str, Any]:
    """The example of a body with every text as long as it may be."""
    found = dict(model.get("example", {}))
    for name, schema in model.get("properties", {}).items():
        text = next((s for s in schema.get("anyOf", [schema]) if s.get("type") == "string" and "maxLength" in s), None)
        if text is not None and name != "session":
            found[name] = longest(text["maxLength"], len(name))
    return found
