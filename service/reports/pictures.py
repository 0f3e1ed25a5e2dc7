"""The charts of the pages as SVG for paper: the same definitions, in the light colours of the pages."""

import json
import re
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import vl_convert

from service.charts import ChartSet, Panel
from service.reports.kept_drawings import KeptDrawings

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
KEPT = KeptDrawings(16 * 1024 * 1024)
"""A certificate is looked at, signed and sent, and drawing it anew takes most of the time. The 25 that are printed at
once have up to 450 drawings of some 2 kB each; one of 4,000 readings has 110 kB."""
KEPT_KINDS = 64
"""Kinds of panels that are kept translated: those of one certificate differ in their data alone."""


def picture(charts: ChartSet, panel: Panel, width: int) -> str:
    """One panel as SVG, ``width`` pixels wide."""
    coloured = VARIABLE.sub(lambda found: PALETTE[found[1]], json.dumps(charts.spec))
    spec: dict[str, Any] = json.loads(coloured)
    datasets = {**spec.pop("datasets", {}), **panel.datasets}
    spec["width"] = width
    spec["config"]["font"] = MEASURED
    kind = json.dumps(spec)
    return KEPT.drawn(json.dumps([kind, datasets]), lambda: _drawn(kind, datasets)).replace(MEASURED, PRINTED)


def _drawn(kind: str, datasets: Mapping[str, Any]) -> str:
    vega = json.loads(_translated(kind))
    for source in vega["data"]:
        if source["name"] in datasets:
            source["values"] = datasets[source["name"]]
    drawn: str = vl_convert.vega_to_svg(json.dumps(vega))
    return drawn


@lru_cache(maxsize=KEPT_KINDS)
def _translated(kind: str) -> str:
    """As Vega, without data."""
    return json.dumps(vl_convert.vegalite_to_vega(kind))
