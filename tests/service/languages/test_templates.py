"""The words of templates: plain text without a mark, sentences with values as Jinja's gettext has them."""

import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest
from jinja2 import Environment
from jinja2.lexer import Token
from markupsafe import Markup

from service.languages.plain_text import FIRST, PLACES, PlainText, flattened
from service.languages.python_sources import SPACED, MessageId
from service.languages.sources import ROOT, TEMPLATES, of_template


@pytest.mark.parametrize(
    ("source", "messages"),
    [
        ("<h1>Flags</h1>", ["Flags"]),
        ("<p>{% if a %}One.{% else %}Two\n  lines.{% endif %}</p>", ["One.", "Two lines."]),
        ('<p><a href="/">One</a> <a href="/b">Two</a></p>', ["One", "Two"]),
        ('<input placeholder="what for" value="not said">', ["what for"]),
        ("<script>say('nothing')</script><style>a { b: c }</style><p>&nbsp;</p>", []),
        ("<p>Within 95 %</p>", ["Within 95 %%"]),
        ('<p lang="en">English <b>everywhere</b>.</p><p>Not this.</p>', ["Not this."]),
        ("<p>{% trans who=page.who %}By {{ who }},\n  twice.{% endtrans %}</p>", ["By %(who)s, twice."]),
        ('<p>{{ _("before") if early else _("after") }}</p>', ["before", "after"]),
        (
            "<p>{% trans n=1 %}{{ n }} unit{% pluralize %}{{ n }} units{% endtrans %}</p>",
            [("%(n)s unit", "%(n)s units")],
        ),
    ],
)
def test_messages_of_a_template(source: str, messages: list[MessageId]) -> None:
    assert list(of_template(source.encode())) == messages


def rendered(source: str, **values: object) -> str:
    environment = Environment(autoescape=True, extensions=["jinja2.ext.i18n", PlainText])
    environment.newstyle_gettext = True  # type: ignore[attr-defined]
    environment.filters["translated"] = lambda value: value if isinstance(value, Markup) else f"[{value}]"
    environment.globals["gettext"] = lambda text, **parts: Markup(text.upper()) % parts
    return environment.from_string(source).render(**values)


def test_text_is_translated_and_values_in_it() -> None:
    assert rendered("<p> One </p><b>{{ a }}</b>", a="<pass>") == "<p> ONE </p><b>[&lt;pass&gt;]</b>"


def test_values_of_attributes_that_machines_read_are_left_alone() -> None:
    assert rendered('<p class="{{ a }}" title="{{ a }}: fit">{{ a }}</p>', a="pass") == (
        '<p class="pass" title="[pass]: FIT">[pass]</p>'
    )


def test_what_people_named_is_left_alone() -> None:
    assert rendered("<p>{{ unit.serial }} {{ note }}</p>", unit={"serial": "none"}, note="fit") == "<p>none fit</p>"


INLINE = "a|abbr|b|code|em|i|small|strong|sub|sup|span|time"
SILENT = re.compile(r"<(script|style|svg)\b.*?</\1>|<(\w+)[^<>]*\slang=\"en\".*?</\2>", re.DOTALL)
CUT = re.compile(
    rf"[A-Za-z]{{2}}[^<>¦¤]*(?:¤|<(?:{INLINE})\b[^<>]*>\s*[\w¤])"
    rf"|(?:¤|[\w¤][.:]?</(?:{INLINE})>)[^<>¦¤]*(?<![&A-Za-z])[A-Za-z]{{2}}"
)
"""Pattern of words beside a value, before an inline element, or after one."""
TEMPLATE_FILES = pytest.mark.parametrize("path", sorted(ROOT.glob(TEMPLATES)), ids=lambda path: path.name)


def tokens(source: str) -> Iterator[Token]:
    """A template as an extension gets it."""
    return Environment(extensions=["jinja2.ext.i18n"])._tokenize(source, None)


def cut(source: str) -> list[str]:
    """Words that are one sentence with a value or a tag beside them."""
    flat, places = flattened(tokens(source))
    kinds = {chr(FIRST + k): "¤" if place[0].type == "variable_begin" else "¦" for k, place in enumerate(places)}
    said = re.sub(r"<[^<>]*>", lambda tag: PLACES.sub("", tag[0]), SILENT.sub("¦", flat))
    return [found[0] for found in CUT.finditer(said.translate(str.maketrans(kinds)))]


@pytest.mark.parametrize(
    "source", ["<p>By {{ who }}</p>", "<p>{{ n }} of them</p>", "<p>Read <a>it</a></p>", "<p><b>{{ x }}</b> is it</p>"]
)
def test_the_test_finds_a_cut_sentence(source: str) -> None:
    assert cut(source)


@TEMPLATE_FILES
def test_no_sentence_is_cut_into_pieces(path: Path) -> None:
    """A sentence with values or tags in it is written in `{% trans %}`, since other languages order it otherwise."""
    assert cut(path.read_text("utf-8")) == []


@TEMPLATE_FILES
def test_a_literal_in_words_is_marked(path: Path) -> None:
    found = tokens(path.read_text("utf-8"))
    texts = [token.value for before, token in pairwise(found) if token.type == "string" and before.type != "lparen"]
    assert [text for text in texts if SPACED.search(text)] == []
