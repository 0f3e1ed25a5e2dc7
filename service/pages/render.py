"""From a frozen context to a page: the one Jinja environment and what every template may use."""

import json
from pathlib import Path
from typing import Any

from fastapi import Request
from fastapi.responses import HTMLResponse
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from service.pages.assets import asset_url
from service.words.conditions import CONDITIONS, REFERENCE, RESERVED
from service.words.names import day_of, heading, spaced
from service.words.verdict import but

TEMPLATES = Path(__file__).parent / "templates"


def embed(data: Any) -> Markup:
    """JSON for a data block of a page; nothing in it can end the block."""
    text = json.dumps(data, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return Markup(text.replace("<", "\\u003c"))


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
    environment.filters.update(but=but, day=day_of, heading=heading, spaced=spaced, embed=embed)
    return environment


_ENVIRONMENT = _environment()


def render(request: Request, template: str, page: Any, status: int = 200) -> HTMLResponse:
    """The page of a frozen context; templates see it as ``page``."""
    text = _ENVIRONMENT.get_template(template).render(page=page, path=request.url.path)
    return HTMLResponse(text, status, headers={"Cache-Control": "no-cache"})
