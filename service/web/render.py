"""A frozen context → a page: the one Jinja environment and the globals of every template."""

import json
from collections.abc import Iterable, MutableMapping
from datetime import datetime
from functools import lru_cache
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl, quote, urlencode

from fastapi import Request
from fastapi.responses import HTMLResponse
from jinja2 import Environment, FileSystemLoader, StrictUndefined, pass_context
from jinja2.runtime import Context
from markupsafe import Markup, escape

from estimator.message import capitalised, joined, say
from estimator.wording import counted
from service.kit.measures import day_of, heading, spaced
from service.kit.person import EVERYBODY, Person, Role
from service.languages.language import QUERY, Language, asked
from service.languages.plain_text import PlainText
from service.sessions.words.conditions import CONDITIONS, REFERENCE, RESERVED, but, but_alone
from service.web.assets import asset_url
from service.web.in_language import TemplateLanguage

SOONEST, LATEST = 2, 60
"""Seconds: a usual diagnosis takes one or two; behind many others it takes minutes."""


def follow_seconds(uploaded_at: datetime, now: datetime, workers: int) -> int | None:
    """Interval of a page's refresh: half of the time so far. None where no background process makes the result."""
    if not workers:
        return None
    return round(min(max((now - uploaded_at).total_seconds() / 2, SOONEST), LATEST))


TEMPLATES = sorted(Path(__file__).parents[1].glob("*/templates"))
"""Each subject has its own; shared ones are here."""


def embed(data: Any) -> Markup:
    """JSON for a data block of a page; nothing in it can end the block."""
    text = json.dumps(data, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return Markup(text.replace("<", "\\u003c"))  # noqa: S704 - no tag can begin in it


@pass_context
def _may(context: Context, role: str) -> bool:
    """Whether the visitor has a role; other actions are not offered."""
    return _person(context).may(Role(role))


@pass_context
def _your_name(context: Context) -> Markup:
    """Name under which a form is sent: the account's, or a field for it where there are no accounts."""
    name, say = _person(context).name, context.environment.filters["translated"]
    if name:
        field = Markup('<input type="hidden" name="by" value="{}"><p class="quiet">{}</p>')
        return field.format(name, say("As {name}").format(name=name))
    field = Markup('<label>{} <input name="by" required maxlength="200" autocomplete="name"></label>')
    return field.format(say("Your name"))


@pass_context
def _csrf_field(context: Context) -> Markup:
    """Proof that a form is from the page given to this browser."""
    csrf = _person(context).csrf
    return Markup('<input type="hidden" name="csrf" value="{}">').format(csrf) if csrf else Markup("")


@pass_context
def _csrf_query(context: Context) -> str:
    """The query of an upload's address with the CSRF token; empty without one."""
    csrf = _person(context).csrf
    return f"?csrf={csrf}" if csrf else ""


def _person(context: Context) -> Person:
    person: Person = context["person"]
    return person


def _joined(parts: Iterable[object], joint: str) -> str:
    """Jinja's own filter would lose the parts of sentences."""
    return joined(joint, map(str, parts))


@lru_cache
def _environment(language: Language) -> Environment:
    """The templates in a language; English is the language of the files."""
    translation = TemplateLanguage(language)
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        extensions=["jinja2.ext.i18n", PlainText],
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.newstyle_gettext = True  # type: ignore[attr-defined]  # of the extension
    environment.policies["ext.i18n.trimmed"] = True
    environment.globals.update(gettext=translation.gettext, ngettext=translation.ngettext)
    environment.globals.update(asset=asset_url, explained=(*CONDITIONS, REFERENCE, RESERVED))
    environment.globals.update(
        may=_may, your_name=_your_name, csrf_field=_csrf_field, csrf_query=_csrf_query, say=say, counted=counted
    )
    environment.filters.update(
        but=but, day=day_of, heading=heading, spaced=spaced, as_sentence=capitalised, but_alone=but_alone
    )
    environment.filters.update(
        join=_joined,
        as_written=escape,
        translated=translation.say,
        embed=lambda data: embed(translation.chart(data)),
    )
    return environment


def render(request: Request, template: str, page: Any, status: int = 200) -> HTMLResponse:
    """The page of a frozen context in the language of the requester; templates see it as ``page``."""
    person = getattr(request.state, "person", EVERYBODY)  # an address that no route took offers what it may
    language = asked(request.scope)
    compiled = _environment(language).get_template(template)
    text = compiled.render(
        page=page,
        path=request.scope["path"],
        person=person,
        language=language,
        languages=[(known, _address(request.scope, known)) for known in Language],
    )
    return HTMLResponse(text, status, headers={"Cache-Control": "no-cache"})


def _address(scope: MutableMapping[str, Any], language: Language) -> str:
    """The address of the same page in another language; for the answer to a form, the fleet's."""
    if scope.get("method", "GET") not in ("GET", "HEAD"):
        return f"/?{urlencode({QUERY: language.value})}"
    asked_for = [pair for pair in parse_qsl(scope["query_string"].decode("latin-1")) if pair[0] != QUERY]
    return f"{quote(scope['path'])}?{urlencode([*asked_for, (QUERY, language.value)])}"
