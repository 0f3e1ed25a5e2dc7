"""Templates of pages in another language: their words are exchanged before Jinja compiles them."""

import re
from collections.abc import Callable, Iterator, Sequence

from service.languages.entry import Entry
from service.languages.pieces import Piece
from service.languages.template import Found, Template, speaking

SAID = re.compile(r"\bsay\(\"([^\"]+)\"")
"""A template with parts: ``{{ say("its {sessions} sessions show", sessions=n) }}``."""
LITERAL = re.compile(r"\"([^\"\\]*)\"|'([^'\\]*)'")
ALONE = re.compile(r"(?:^\{\{\s*\(?|\belse\s+|\bor\s+)$")
"""After what a literal of an expression is its value."""
SENTENCE = re.compile(r"^[^\W\d_].* .*\w|^[A-Z][a-z]+[.:]?$|^ .*[a-z]{2} .|[a-z]{2} $|^; ")
"""A literal that is words wherever it stands: several of them, or one that begins with a capital letter."""
WORDS = re.compile(r"[\w ,;:.]*[a-z]{2,}[\w ,;:.]*")
NOT_SAID = re.compile(r"[/<>=&?#_]|^[a-z]+(-[a-z]+)+$")
"""What an address or a key has, and words have not."""
IN_MESSAGE = re.compile(r"\{(\w+)\}|</?([a-z]\w*)>")
Forms = Callable[[Entry], Sequence[str]]
"""What a catalogue has for a message: a text, or one for every plural form; empty where it has nothing."""


def in_language(source: str, forms: Forms, name: str = "") -> str:
    """The template in another language; what the catalogue does not have stays as it is."""
    template = Template(source, name)
    out, at = list[str](), 0
    for found in template.messages():
        said = forms(found.message)
        if said and found.start >= at:
            out += [template.spoken_source(at, found.start), _chosen(template, found, said)]
            at = found.end
    return "".join((*out, template.spoken_source(at, len(template.flat))))


def _chosen(template: Template, found: Found, said: Sequence[str]) -> str:
    """The message in its language: of a counted thing the form of its number, which Jinja chooses."""
    texts = [_filled(template, found.piece, form) for form in said]
    if len(texts) == 1:
        return texts[0]
    others = "".join(f"{{% elif ({found.piece.counted})|plural_form == {k} %}}{t}" for k, t in enumerate(texts) if k)
    return f"{{% if ({found.piece.counted})|plural_form == 0 %}}{texts[0]}{others}{{% endif %}}"


def _filled(template: Template, piece: Piece, text: str) -> str:
    def put(match: re.Match[str]) -> str:
        if match[2] and match.group().startswith("</"):
            return f"</{piece.kinds[match[2]]}>"
        source = piece.sources[match[1] or match[2]]
        return speaking(source) if source.startswith("{{") else template.whole(source)

    return IN_MESSAGE.sub(put, text)


def literals(template: Template) -> Iterator[str]:
    """Words inside of expressions and statements, ``{{ "before" if early else "after" }}``."""
    for part, is_told in template.jinja():
        yield from SAID.findall(part)
        for match in LITERAL.finditer(part):
            text = match[1] or match[2] or ""
            lone = is_told and part.startswith("{{") and ALONE.search(part[: match.start()])
            if not NOT_SAID.search(text) and (SENTENCE.search(text) or (lone and WORDS.fullmatch(text))):
                yield text
