"""A frozen record → a PDF by typst; the record is passed as data, never as part of the source."""

import json
import re
from collections.abc import Mapping
from datetime import datetime
from functools import lru_cache
from pathlib import Path
from typing import Any

from estimator.json_object import Json
from service.kit.libraries import typst, vl_convert
from service.kit.printable import printable_data
from service.languages.catalogue import catalogue_of
from service.languages.documents import SAY_CALL, document_in
from service.languages.language import Language
from service.sessions.charts import ChartSet, Panel

TEMPLATES = Path(__file__).parent / "templates"
"""The only folder that typst may read."""
ENGLISH = Language.ENGLISH


def typeset(template: str, record: Any, at: datetime, language: Language = ENGLISH) -> bytes:
    """The document of a frozen record; the same record always gives the same bytes. ``at`` is its date."""
    return _compiled(template, record, language, format="pdf", timestamp=at.replace(microsecond=0))


def typeset_svg(template: str, record: Any, language: Language = ENGLISH) -> bytes:
    """The one page of a frozen record as a drawing."""
    return _compiled(template, record, language, format="svg")


def _compiled(template: str, record: Any, language: Language, **options: Any) -> bytes:
    data = printable_data(record)
    if language is not ENGLISH:
        data = document_in(data, catalogue_of(language).say)
    inputs = {"data": data, "words": {"language": language.value, "said": _words(language)}}
    document = typst.compile(
        TEMPLATES / template,
        root=TEMPLATES,
        sys_inputs={name: json.dumps(value, ensure_ascii=False, allow_nan=False) for name, value in inputs.items()},
        ignore_system_fonts=True,
        **options,
    )
    assert isinstance(document, bytes)
    return document


@lru_cache
def _words(language: Language) -> Mapping[str, str]:
    """Translations of the templates' texts; English is in the templates."""
    if language is ENGLISH:
        return {}
    texts = (text for path in sorted(TEMPLATES.glob("*.typ")) for text in SAY_CALL.findall(path.read_text("utf-8")))
    return {text: catalogue_of(language).form(text) for text in texts}


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
"""The light colours of the pages' style; a test compares them."""
VARIABLE = re.compile(r"var\(--([\w-]+)\)")
"""Reference to a colour of the pages' style in a specification."""
LAYOUT_FONT, PRINT_FONT = "Liberation Sans", "Libertinus Serif"
"""The font for the layout of charts, a little wider, and the one in which they are printed."""


def picture(charts: ChartSet, panel: Panel, width: int, language: Language = Language.ENGLISH) -> str:
    """One panel as SVG, ``width`` pixels wide, with translated words."""
    definition = {**charts.spec, "datasets": {**charts.spec.get("datasets", {}), **panel.datasets}, "width": width}
    if language is not Language.ENGLISH:
        definition = catalogue_of(language).chart(definition)
    spec: Json = json.loads(VARIABLE.sub(lambda found: PALETTE[found[1]], json.dumps(definition)))
    spec["config"]["font"] = LAYOUT_FONT
    svg: str = vl_convert.vegalite_to_svg(spec)
    return svg.replace(LAYOUT_FONT, PRINT_FONT)
