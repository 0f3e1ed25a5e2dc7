"""Links of each role at the top of every page."""

from dataclasses import replace

import pytest
from fastapi import Request
from lxml import html

from service.kit.person import EVERYBODY, Person, Role
from service.pages.help import help_page
from service.web.render import render

CREW = replace(EVERYBODY, login="crew", name="Crew", role=Role.CREW)
ENGINEER = replace(EVERYBODY, login="engineer", name="Engineer", role=Role.ENGINEER)
VIEWER = replace(EVERYBODY, login="viewer", name="Viewer", role=Role.VIEWER)
REST = ["/sessions", "/stands", "/unit-types", "/plan", "/jobs"]


def links(person: Person, where: str) -> list[str]:
    """Addresses of the main navigation: directly in it, or under *More*."""
    scope = {"type": "http", "path": "/help", "headers": [], "query_string": b"", "state": {"person": person}}
    page = html.fromstring(bytes(render(Request(scope), "help.html", help_page()).body).decode())
    return [str(address) for address in page.xpath(f"//nav[@aria-label='Main']/{where}/@href")]


@pytest.mark.parametrize("person", [EVERYBODY, CREW])
def test_a_crew_sees_what_it_works_with_first(person: Person) -> None:
    assert links(person, "a") == ["/", "/upload", "/flags", "/help"]
    assert links(person, "details//a") == REST


def test_an_engineer_has_everything_at_hand() -> None:
    assert links(ENGINEER, "a") == ["/", "/upload", "/flags", "/help", *REST]


def test_who_only_reads_uploads_nothing() -> None:
    assert links(VIEWER, "a") == ["/", "/flags", "/help"]
