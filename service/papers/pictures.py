"""The charts of the pages as SVG for paper: the same definitions, in the light colours of the pages."""

import json
import re
from typing import Any

import vl_convert

from service.languages.catalogue import catalogue_of
from service.languages.language import Language
from service.sessions.charts import ChartSet, Panel

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
    spec: dict[str, Any] = json.loads(VARIABLE.sub(lambda found: PALETTE[found[1]], json.dumps(told)))
    spec["config"]["font"] = MEASURED
    drawn: str = vl_convert.vegalite_to_svg(spec)
    return drawn.replace(MEASURED, PRINTED)
