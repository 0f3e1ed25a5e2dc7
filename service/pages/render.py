"""From a frozen context to a page: the one Jinja environment and what every template may use."""

import json
from pathlib import Path
from typing import Any

from fastapi import Request
from fastapi.responses import HTMLResponse
from jinja2 import Environment, FileSystemLoader, StrictUndefined, pass_context
from jinja2.runtime import Context
from markupsafe import Markup

from service.pages.assets import asset_url
from service.records.identity import EVERYBODY, Person, Role
from service.words.conditions import CONDITIONS, REFERENCE, RESERVED
from service.words.names import day_of, heading, spaced
from service.words.verdict import but

TEMPLATES = Path(__file__).parent / "templates"


def embed(data: Any) -> Markup:
    """JSON for a data block of a page; nothing in it can end the block."""
    text = json.dumps(data, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return Markup(text.replace("<", "\\u003c"))  # noqa: S704 - no tag can begin in it


@pass_context
def _may(context: Context, role: str) -> bool:
    """Whether the one who looks may do what a role may; what they may not is not offered."""
    return _person(context).may(Role(role))


@pass_context
def _your_name(context: Context) -> Markup:
    """Under what a form is sent: the account's name, or a field for it where nobody signs in."""
    name = _person(context).name
    if name:
        return Markup('<input type="hidden" name="by" value="{0}"><p class="quiet">As {0}</p>').format(name)
    return Markup('<label>Your name <input name="by" required maxlength="200" autocomplete="name"></label>')


@pass_context
def _csrf_field(context: Context) -> Markup:
    """What proves that a form is of the page that this browser was given."""
    csrf = _person(context).csrf
    return Markup('<input type="hidden" name="csrf" value="{}">').format(csrf) if csrf else Markup("")


@pass_context
def _csrf_query(context: Context) -> str:
    """The same, for the address of an upload."""
    csrf = _person(context).csrf
    return f"?csrf={csrf}" if csrf else ""


def _person(context: Context) -> Person:
    person: Person = context["person"]
    return person


def _environment() -> Environment:
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals.update(
        asset=asset_url, conditions=CONDITIONS, explained=(*CONDITIONS, REFERENCE, RESERVED), reserved=RESERVED
    )
    environment.globals.update(may=_may, your_name=_your_name, csrf_field=_csrf_field, csrf_query=_csrf_query)
    environment.filters.update(but=but, day=day_of, heading=heading, spaced=spaced, embed=embed)
    return environment


_ENVIRONMENT = _environment()


def render(request: Request, template: str, page: Any, status: int = 200) -> HTMLResponse:
    """The page of a frozen context; templates see it as ``page``."""
    person = getattr(request.state, "person", EVERYBODY)  # an address that no route took offers what it may
    text = _ENVIRONMENT.get_template(template).render(page=page, path=request.scope["path"], person=person)
    return HTMLResponse(text, status, headers={"Cache-Control": "no-cache"})
