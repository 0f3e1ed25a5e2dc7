"""One service in which all pages were followed: each test brings units and stands of its own."""

from collections.abc import Iterator
from dataclasses import dataclass

import httpx
import pytest

from tests.how_to.follow import followed

PAGES = ("add-a-cause", "add-a-page", "add-a-programme", "add-a-reader", "add-a-yes-or-no")


@dataclass(frozen=True)
class Served:
    """The service."""

    http: httpx.Client
    seating: str
    """The new page before anything was uploaded."""


@pytest.fixture(scope="session")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """The service of such a copy."""
    house = followed(tmp_path_factory.mktemp("all"), *PAGES)
    with house.serving() as address, httpx.Client(base_url=address) as http:
        yield Served(http, http.get("/seating").text)
