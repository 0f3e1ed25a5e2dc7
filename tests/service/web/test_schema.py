"""The service keeps its own description: generated requests, no 5xx, answers that match."""

from collections.abc import Iterator
from contextlib import nullcontext, suppress

import httpx
import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis.errors import Unsatisfiable
from schemathesis import GenerationMode

from tests.conftest import StockOf
from tests.patience import LONG
from tests.service.made_sessions import session_bytes
from tests.serving import serving

EXAMPLES = 2
"""Examples of each call, where there is more time; docs/security/http.md has the results of thousands of requests."""


@pytest.fixture(scope="module")
def address(request: pytest.FixtureRequest, stock_of: StockOf) -> Iterator[str]:
    """A service with two sessions of one unit."""
    stock = stock_of(request.getfixturevalue(request.param))
    with stock.holding(session_bytes(), session_bytes(seed=2, month=4)) as settings, serving(settings) as url:
        yield url


@pytest.fixture(scope="module")
def description(address: str) -> schemathesis.BaseSchema:
    """The service's description of itself."""
    return schemathesis.openapi.from_url(f"{address}/openapi.json", timeout=LONG)


@pytest.mark.parametrize(
    ("address", "mode", "examples"),
    [
        ("postgresql", GenerationMode.POSITIVE, 1),  # it refuses more than SQLite
        pytest.param("postgresql", GenerationMode.POSITIVE, EXAMPLES, marks=pytest.mark.slow),
        # is refused before the database is asked
        pytest.param("sqlite", GenerationMode.NEGATIVE, EXAMPLES, marks=pytest.mark.slow),
    ],
    indirect=["address"],
)
def test_generated_requests_are_answered_as_described(
    description: schemathesis.BaseSchema, mode: GenerationMode, examples: int
) -> None:
    """Requests that keep the description, and requests that break it wherever it can be broken."""
    operations = [found.ok() for found in description.get_all_operations()]  # type: ignore[union-attr]
    assert len(operations) > 15
    for operation in operations if mode is GenerationMode.POSITIVE else asking_for_more(operations):
        # Where nothing is asked for, nothing can be broken.
        with suppress(Unsatisfiable) if mode is GenerationMode.NEGATIVE else nullcontext():
            assert_conforming(operation, mode, examples)


def asking_for_more(operations: list[schemathesis.APIOperation]) -> Iterator[schemathesis.APIOperation]:
    """Operations with a body, or with a parameter that none before them has: one declaration is broken only once."""
    known: set[str] = set()
    for operation in operations:
        asked = {repr(parameter.definition) for parameter in operation.iter_parameters()}
        if operation.body or asked - known:
            yield operation
        known |= asked


def assert_conforming(operation: schemathesis.APIOperation, mode: GenerationMode, examples: int) -> None:
    """Sends generated requests and holds every answer to the description."""

    @settings(
        max_examples=examples,
        derandomize=True,
        deadline=None,
        database=None,
        phases=[Phase.explicit, Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(case=operation.as_strategy(generation_mode=mode))
    def conforms(case: schemathesis.Case) -> None:
        # What a schema cannot say of a session file, a unit that exists or a time in the past is refused with 4xx.
        case.call_and_validate(excluded_checks=[schemathesis.checks.positive_data_acceptance], timeout=LONG)

    conforms()


@pytest.mark.parametrize("address", ["sqlite"], indirect=True)
def test_every_field_and_parameter_is_described(address: str) -> None:
    found = httpx.get(f"{address}/openapi.json").json()
    bare = [
        f"{name}.{field}"
        for name, model in found["components"]["schemas"].items()
        for field, spec in model.get("properties", {}).items()
        if "description" not in spec and "$ref" not in spec
    ]
    bare += [
        f"{path} {parameter['name']}"
        for path, operations in found["paths"].items()
        for operation in operations.values()
        for parameter in operation.get("parameters", [])
        if "description" not in parameter
    ]
    assert bare == []
