"""The charts of the paper are those of the pages, and are kept for the next look."""

import json
import re

import vl_convert

from estimator.calibration import calibrate
from estimator.reading import read_session
from service.charts.residuals import residual_charts
from service.reports.certificate.drawings import WIDTH
from service.reports.kept_drawings import KeptDrawings
from service.reports.pictures import MEASURED, PALETTE, PRINTED, VARIABLE, picture
from tests import builders

CLIP = re.compile(r"clip\d+")
"""Numbered through all that the process draws."""


def test_a_panel_is_drawn_with_its_own_data_as_its_whole_specification_says() -> None:
    charts = residual_charts(calibrate(read_session(builders.accelerometer_block(3))))[0]
    drawn = [picture(charts, panel, WIDTH) for panel in charts.panels]
    for panel, svg in zip(charts.panels, drawn, strict=True):
        spec = json.loads(VARIABLE.sub(lambda found: PALETTE[found[1]], json.dumps(charts.spec)))
        spec |= {"datasets": {**spec.get("datasets", {}), **panel.datasets}, "width": WIDTH}
        spec["config"]["font"] = MEASURED
        whole = vl_convert.vegalite_to_svg(spec).replace(MEASURED, PRINTED)
        assert CLIP.sub("", svg) == CLIP.sub("", whole)
    assert len(set(drawn)) == 3


def test_what_was_drawn_is_kept_until_too_much_newer_is() -> None:
    kept, drawn = KeptDrawings(60), list[str]()

    def ask(name: str) -> None:
        assert kept.drawn(name, lambda: drawn.append(name) or f"<svg>{name}</svg>") == f"<svg>{name}</svg>"

    for name in ("first", "second", "first", "third", "first", "second"):
        ask(name)
    assert drawn == ["first", "second", "third", "second"]
