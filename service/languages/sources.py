"""Sources of messages: the templates, the typesetter's templates, and the modules with texts for people."""

import re
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path

from babel.messages.extract import extract

from estimator.causes import CATALOGUE, OF_SEVERAL, ON_TURNTABLE, Cause
from estimator.message import PLACE
from service.languages import python_sources
from service.languages.documents import SAY_CALL
from service.languages.plain_text import PlainText
from service.languages.python_sources import LETTERS, MessageId
from service.languages.short import COUNTED, NAMES, STANDING_ALONE

ROOT = Path(__file__).parents[2]
TEMPLATES = "service/*/templates/*.html"
CALLS = {"_": None, "gettext": None, "ngettext": (1, 2), "say": None}
"""Calls in templates whose first texts are messages."""
OPTIONS = {
    "extensions": f"{PlainText.__module__}.{PlainText.__name__}",
    "newstyle_gettext": "true",
    "trimmed": "true",
    "silent": "false",
}
"""Jinja's settings for extraction, as in `service.web.render`; a template that it cannot read is an error."""
PAPERS = "service/papers/templates"
HEADING_MODULES = re.compile(
    r"service/(kit/(measures|failure)|web/(in_language|list_view|problem_pages|render)|(pages|papers|planning)/"
    r"|.*/(records|words|charts|pages|sections|decision|doubt|states|condition|populations)\b"
    r"|.*_pages\.py|.*/(view|gain|lines|conditions|template|preview|pattern|layout/)"
    r"|outlook/reading|ingest/session_keys)"
)
"""Modules in which single capitalised words are shown to people too."""
SETTINGS = "service/settings.py"
"""Module of the settings; a page shows their descriptions."""
COMMANDS = ("service/client/connection.py", "service/commands/*.py")
"""Modules in which only the texts in calls are for people: their help stays English."""
PACKAGES = ("service", "estimator")
IGNORED = (
    "service/app.py",
    "service/cli.py",
    "service/client",
    "service/commands",
    "service/demo",
    "service/outlook/api.py",
    "service/flags/mail.py",
    "service/flags/messages.py",
    "service/ingest/fork_server.py",
    "service/ingest/layout/vocabulary.py",
    "service/kit/bell.py",
    "service/kit/log.py",
    "service/kit/metrics.py",
    "service/kit/printable.py",
    "service/languages",
    "service/pages/fleet/api.py",
    "service/sessions/schemas.py",
    "service/pages/unit/schemas.py",
    "service/papers/correction.py",
    "service/papers/dcc",
    "service/papers/onboard",
    "service/papers/schemas.py",
    "service/papers/seal/xml.py",
    "service/papers/verifying/compare.py",
    "service/papers/verifying/records.py",
    "service/papers/verifying/stated.py",
    "service/people/access.py",
    "service/records/flagging/overdue_units.py",
    "service/records/many.py",
    "service/sessions/schema.py",
    "service/storage/backup",
    "service/storage/engine.py",
    "service/queue/tables.py",
    "service/storage/schema.py",
    "service/records/event_schemas.py",
    "service/web/fields.py",
    "service/web/headers.py",
    "service/all_api.py",
    "service/web/problem_document.py",
    "service/web/server.py",
    "service/work/helper.py",
    "service/work/kinds.py",
    "service/work/loop.py",
    "service/work/watch.py",
    "estimator/__init__.py",
    "estimator/codec.py",
    "estimator/alignment/simulate.py",
    "estimator/hiding",
    "estimator/on_demand.py",
    "estimator/reading/bounds.py",
    "estimator/wording.py",
)
"""Texts for programs, for the operator, or fixed by a standard."""


Found = tuple[MessageId, str]
"""A message and its place."""


def messages() -> Iterator[Found]:
    """Every message of the product, in the order of its files; some occur in several."""
    return (
        (text, place)
        for text, place in _all()
        if LETTERS.search(PLACE.sub(" ", text[0] if isinstance(text, tuple) else text)) and text not in NAMES
    )


def _all() -> Iterator[Found]:
    yield from ((word, "service/languages/short.py") for word in STANDING_ALONE)
    yield from (
        (text, "estimator/causes") for cause in (*CATALOGUE, *ON_TURNTABLE, *OF_SEVERAL) for text in _names_of(cause)
    )
    yield from (((f"{{n}} {thing}", f"{{n}} {thing}s"), "service/languages/short.py") for thing in COUNTED)
    for path in sorted(ROOT.glob(TEMPLATES)):
        yield from ((text, path.name) for text in of_template(path.read_bytes()))
    for path in sorted((ROOT / PAPERS).glob("*.typ")):
        yield from ((text, path.name) for text in SAY_CALL.findall(path.read_text("utf-8")))
    for path in sorted(path for pattern in COMMANDS for path in ROOT.glob(pattern)):
        name = path.relative_to(ROOT).as_posix()
        yield from ((text, name) for text in python_sources.said(path.read_text("utf-8")))
    for path in modules():
        name = path.relative_to(ROOT).as_posix()
        source = path.read_text("utf-8")
        headings, described = HEADING_MODULES.match(name) is not None and not name.endswith("api.py"), name == SETTINGS
        yield from ((text, name) for text in python_sources.messages(source, headings=headings, described=described))


def of_template(source: bytes) -> Iterator[MessageId]:
    """The messages of a template, by Babel's extraction for Jinja."""
    yield from (text for _, text, _, _ in extract("jinja2.ext:babel_extract", BytesIO(source), CALLS, options=OPTIONS))


def _names_of(cause: Cause) -> Iterator[str]:
    yield from filter(re.compile(r"[a-z]{2}").search, (cause.name, cause.shape_words, *cause.amplitude_words))


def modules() -> Iterator[Path]:
    """Modules with texts for people."""
    for path in sorted(p for room in PACKAGES for p in (ROOT / room).rglob("*.py")):
        if not path.relative_to(ROOT).as_posix().startswith(IGNORED):
            yield path
