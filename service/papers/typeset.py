"""From a frozen record to a PDF by typst, which is given what the record says as data, never as part of its source."""

import json
from collections.abc import Mapping
from datetime import datetime
from functools import lru_cache
from pathlib import Path
from typing import Any

import typst

from service.kit.printable import printable_data
from service.languages import typst_sources
from service.languages.catalogue import catalogue_of
from service.languages.documents import document_in
from service.languages.language import Language

TEMPLATES = Path(__file__).parent / "templates"
"""The only folder that typst may read."""
ENGLISH = Language.ENGLISH


def typeset(template: str, record: Any, at: datetime, language: Language = ENGLISH) -> bytes:
    """The document of a frozen record; the same record gives the same bytes. ``at`` is the date that it carries."""
    return _compiled(template, record, language, format="pdf", timestamp=at.replace(microsecond=0))


def typeset_svg(template: str, record: Any, language: Language = ENGLISH) -> bytes:
    """The one page of a frozen record as a drawing."""
    return _compiled(template, record, language, format="svg")


def _compiled(template: str, record: Any, language: Language, **wanted: Any) -> bytes:
    data = printable_data(record)
    if language is not ENGLISH:
        data = document_in(data, catalogue_of(language).say)
    given = {"data": data, "words": {"language": language.value, "said": _words(language)}}
    document = typst.compile(
        TEMPLATES / template,
        root=TEMPLATES,
        sys_inputs={name: json.dumps(one, ensure_ascii=False, allow_nan=False) for name, one in given.items()},
        ignore_system_fonts=True,
        **wanted,
    )
    assert isinstance(document, bytes)
    return document


@lru_cache
def _words(language: Language) -> Mapping[str, str]:
    """What the templates say themselves, in a language; English is what stands in them."""
    if language is ENGLISH:
        return {}
    sources = (path.read_text("utf-8") for path in sorted(TEMPLATES.glob("*.typ")))
    found = [one for source in sources for one in typst_sources.messages(source, "")]
    return {one.text: forms[0] for one in found if (forms := catalogue_of(language).forms(one))}
