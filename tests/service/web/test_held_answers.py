"""Records that the API answers with as they are."""

from dataclasses import dataclass, replace
from datetime import UTC, datetime
from math import nan

import httpx
import pytest
from pydantic import TypeAdapter, computed_field

from service.kit.answer import Hidden, answer


@answer
@dataclass(frozen=True)
class Reading:
    """A reading of an instrument."""

    secret: Hidden[str]
    """Told to nobody."""
    value: float = 1.0
    """SI; on a text
    of two lines."""
    at: datetime = datetime(2026, 3, 1, 9, tzinfo=UTC)
    """When, UTC."""

    @computed_field  # type: ignore[prop-decorator]
    @property
    def double(self) -> float:
        """Twice the value."""
        return 2 * self.value


@answer
@dataclass(frozen=True)
class Kept(Reading):
    """The same, as it is kept."""

    number: int = 0
    """Number of the entry."""


TEXTS = {"value": "SI; on a text of two lines.", "at": "When, UTC.", "double": "Twice the value."}


@pytest.mark.parametrize(("record", "more"), [(Reading, {}), (Kept, {"number": "Number of the entry."})])
def test_a_field_is_described_by_what_stands_under_it(record: type, more: dict[str, str]) -> None:
    described = TypeAdapter(record).json_schema(mode="serialization")
    assert {name: field["description"] for name, field in described["properties"].items()} == TEXTS | more
    assert set(described["required"]) == set(TEXTS | more)
    assert described["description"] == record.__doc__


def test_an_answer_holds_all_but_hidden_fields() -> None:
    told = TypeAdapter(Reading).dump_json(replace(Reading("abc"), value=nan))
    assert told == b'{"value":null,"at":"2026-03-01T09:00:00Z","double":null}'


def test_no_answer_describes_a_secret_that_is_kept(client: httpx.Client) -> None:
    schemas = client.get("/openapi.json").json()["components"]["schemas"]
    assert {name for name, own in schemas.items() if {"secret", "csrf"} & set(own.get("properties", ()))} == {
        "MadeToken",
        "NewWebhook",
    }
