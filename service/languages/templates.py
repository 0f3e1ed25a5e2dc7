"""Translation of page templates, before Jinja compiles them."""

import re
from collections.abc import Callable, Iterator, Sequence

from service.languages.entry import MessageEntry
from service.languages.pieces import Piece
from service.languages.template import Template, TemplateMessage, translating

SAY_CALL = re.compile(r"\bsay\(\"([^\"]+)\"")
"""A template with parts: ``{{ say("its {sessions} sessions show", sessions=n) }}``."""
LITERAL = re.compile(r"\"([^\"\\]*)\"|'([^'\\]*)'")
VALUE_POSITION = re.compile(r"(?:^\{\{\s*\(?|\belse\s+|\bor\s+)$")
"""Text before a literal that is the value of an expression."""
SENTENCE = re.compile(r"^[^\W\d_].* .*\w|^[A-Z][a-z]+[.:]?$|^ .*[a-z]{2} .|[a-z]{2} $|^; ")
"""A literal that is words anywhere: several of them, or a capitalised one."""
WORDS = re.compile(r"[\w ,;:.]*[a-z]{2,}[\w ,;:.]*")
ADDRESS_OR_KEY = re.compile(r"[/<>=&?#_]|^[a-z]+(-[a-z]+)+$")
"""Pattern of addresses and keys, which words do not contain."""
IN_MESSAGE = re.compile(r"\{(\w+)\}|</?([a-z]\w*)>")
Forms = Callable[[MessageEntry], Sequence[str]]
"""Translations of a message: a text, or one for every plural form; empty where there is none."""


def in_language(source: str, forms: Forms) -> str:
    """The template in another language; untranslated messages stay."""
    template = Template(source)
    output, position = list[str](), 0
    for occurrence in template.messages():
        translations = forms(occurrence.message)
        if translations and occurrence.start >= position:
            output += [template.spoken_source(position, occurrence.start), _chosen(template, occurrence, translations)]
            position = occurrence.end
    return "".join((*output, template.spoken_source(position, len(template.flat))))


def _chosen(template: Template, occurrence: TemplateMessage, translations: Sequence[str]) -> str:
    """The translated message: of a counted thing the plural form, which Jinja chooses."""
    texts = [_filled(template, occurrence.piece, form) for form in translations]
    if len(texts) == 1:
        return texts[0]
    further = "".join(
        f"{{% elif ({occurrence.piece.counted})|plural_form == {k} %}}{t}" for k, t in enumerate(texts) if k
    )
    return f"{{% if ({occurrence.piece.counted})|plural_form == 0 %}}{texts[0]}{further}{{% endif %}}"


def _filled(template: Template, piece: Piece, text: str) -> str:
    def put(match: re.Match[str]) -> str:
        if match[2] and match.group().startswith("</"):
            return f"</{piece.kinds[match[2]]}>"
        source = piece.sources[match[1] or match[2]]
        return translating(source) if source.startswith("{{") else template.whole(source)

    return IN_MESSAGE.sub(put, text)


def literals(template: Template) -> Iterator[str]:
    """Words inside of expressions and statements, ``{{ "before" if early else "after" }}``."""
    for part, is_text in template.jinja():
        yield from SAY_CALL.findall(part)
        for match in LITERAL.finditer(part):
            text = match[1] or match[2] or ""
            is_value = is_text and part.startswith("{{") and VALUE_POSITION.search(part[: match.start()])
            if not ADDRESS_OR_KEY.search(text) and (SENTENCE.search(text) or (is_value and WORDS.fullmatch(text))):
                yield text
