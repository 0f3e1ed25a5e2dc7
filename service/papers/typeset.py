"""From a frozen record to a PDF by typst, which is given what the record says as data, never as part of its source."""

import json
import re
from collections.abc import Mapping
from datetime import datetime
from functools import lru_cache
from pathlib import Path
from typing import Any

import typst
import vl_convert

from estimator.json_object import Json
from service.kit.printable import printable_data
from service.languages import typst_sources
from service.languages.catalogue import catalogue_of
from service.languages.documents import document_in
from service.languages.language import Language
from service.sessions.charts import ChartSet, Panel

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


PALETTE = {
    "card": "#ffffff",
    "ink": "#1b2328",
    "muted": "#56626a",
    "line": "#d9dedb",
    "grid": "#eceeec",
    "accent": "#0d5878",
    "second": "#b0561c",
    "tolerance": "#a8324a",
    "pass": "#1b7a4c",
    "conditional-pass": "#8f6200",
    "conditional-fail": "#b4490f",
    "fail": "#b3261e",
    "undecidable": "#55606b",
    "reference": "#0d5878",
    "none": "#626d75",
}
"""The light colours of the pages' style; a test holds them to it."""
VARIABLE = re.compile(r"var\(--([\w-]+)\)")
"""How a specification names a colour of the pages' style."""
MEASURED, PRINTED = "Liberation Sans", "Libertinus Serif"
"""The font that charts are laid out with, a little wider, and the one that they are printed in."""


def picture(charts: ChartSet, panel: Panel, width: int, language: Language = Language.ENGLISH) -> str:
    """One panel as SVG, ``width`` pixels wide, its words in a language."""
    told = {**charts.spec, "datasets": {**charts.spec.get("datasets", {}), **panel.datasets}, "width": width}
    if language is not Language.ENGLISH:
        told = catalogue_of(language).chart(told)
    spec: Json = json.loads(VARIABLE.sub(lambda found: PALETTE[found[1]], json.dumps(told)))
    spec["config"]["font"] = MEASURED
    drawn: str = vl_convert.vegalite_to_svg(spec)
    return drawn.replace(MEASURED, PRINTED)
