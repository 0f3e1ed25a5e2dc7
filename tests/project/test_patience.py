"""No test depends on how fast the machine is: none gives up on what only takes long, and none guesses how long."""

import ast
import inspect
from collections.abc import Iterator
from pathlib import Path

import httpx

from tests.patience import LONG

TESTS = Path(__file__).parents[1]
PAUSES = {"tests/service/storage/test_turns.py"}
"""Files in which a pause of no length lets another thread go on."""


def calls(word: str) -> Iterator[tuple[str, ast.Call]]:
    """Every call in the tests' files that hold a word, with its place."""
    for path in sorted(TESTS.rglob("*.py")):
        source = path.read_text("utf-8")
        if word not in source:
            continue
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.Call):
                yield f"{path.relative_to(TESTS.parent)}:{node.lineno}", node


def test_nothing_is_given_up_after_seconds_that_a_test_chose() -> None:
    short = [
        place
        for place, call in calls("timeout")
        for word in call.keywords
        if word.arg == "timeout" and isinstance(word.value, ast.Constant) and word.value.value is not None
    ]
    assert short == []


def test_no_test_sleeps() -> None:
    names = ((place, ast.unparse(call.func)) for place, call in calls("sleep"))
    sleeping = [place for place, name in names if name in ("sleep", "time.sleep")]
    assert [place for place in sleeping if place.rpartition(":")[0] not in PAUSES] == []


def test_http_waits_long_where_nothing_else_is_said() -> None:
    usual = inspect.signature(httpx.get).parameters["timeout"].default
    assert httpx.Timeout(usual) == httpx.Timeout(LONG)
