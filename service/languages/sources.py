"""Sources of messages: the templates, the typesetter's templates, and the modules with texts for people."""

import re
from collections.abc import Iterator
from pathlib import Path

from estimator.causes import CATALOGUE, OF_SEVERAL, ON_TURNTABLE, Cause
from estimator.message import PLACE
from service.languages import python_sources
from service.languages.entry import LETTERS, MessageEntry
from service.languages.short import COUNTED, NAMES, STANDING_ALONE
from service.languages.template import Template
from service.languages.templates import SAY_CALL, literals

ROOT = Path(__file__).parents[2]
TEMPLATES = "service/*/templates/*.html"
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


def messages() -> Iterator[MessageEntry]:
    """Every message of the product, in the order of its files; some occur in several."""
    return (message for message in _all() if LETTERS.search(PLACE.sub(" ", message.text)) and message.text not in NAMES)


def _all() -> Iterator[MessageEntry]:
    yield from (MessageEntry(word, place="service/languages/short.py") for word in STANDING_ALONE)
    yield from (
        MessageEntry(text, place="estimator/causes")
        for cause in (*CATALOGUE, *ON_TURNTABLE, *OF_SEVERAL)
        for text in _names_of(cause)
    )
    yield from (MessageEntry(f"{{n}} {thing}", f"{{n}} {thing}s", "service/languages/short.py") for thing in COUNTED)
    for path in sorted(ROOT.glob(TEMPLATES)):
        template = Template(path.read_text("utf-8"), path.name)
        yield from (found.message for found in template.messages())
        yield from (MessageEntry(text, place=path.name) for text in literals(template))
    for path in sorted((ROOT / PAPERS).glob("*.typ")):
        yield from (MessageEntry(text, place=path.name) for text in SAY_CALL.findall(path.read_text("utf-8")))
    for path in sorted(path for pattern in COMMANDS for path in ROOT.glob(pattern)):
        yield from python_sources.said(path.read_text("utf-8"), path.relative_to(ROOT).as_posix())
    for path in modules():
        name = path.relative_to(ROOT).as_posix()
        source = path.read_text("utf-8")
        headings, described = HEADING_MODULES.match(name) is not None and not name.endswith("api.py"), name == SETTINGS
        yield from python_sources.messages(source, name, headings=headings, described=described)


def _names_of(cause: Cause) -> Iterator[str]:
    yield from filter(re.compile(r"[a-z]{2}").search, (cause.name, cause.shape_words, *cause.amplitude_words))


def modules() -> Iterator[Path]:
    """Modules with texts for people."""
    for path in sorted(p for room in PACKAGES for p in (ROOT / room).rglob("*.py")):
        if not path.relative_to(ROOT).as_posix().startswith(IGNORED):
            yield path
