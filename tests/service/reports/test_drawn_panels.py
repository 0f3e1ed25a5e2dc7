"""The charts of the paper are those of the pages, and are kept for the next look."""

import json
import re

import vl_convert

from estimator.calibration import calibrate
from estimator.reading import read_session
from service.api.printing import MOST
from service.charts.residuals import residual_charts
from service.reports.certificate.drawings import MOST_HISTORIES, MOST_RESIDUALS, WIDTH
from service.reports.pictures import KEPT, MEASURED, PALETTE, PRINTED, VARIABLE, picture
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


def test_all_that_is_printed_at_once_is_kept() -> None:
    assert KEPT >= MOST * (MOST_HISTORIES + MOST_RESIDUALS)
