"""A parabola over temperature is named as one and a line as a line, of bias and scale factor: neither is a rival."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import diagnose
from estimator.causes import cause
from estimator.diagnosis import Finding
from tests.estimator.causes.hiding import change, scene_for, spoilt, with_readings
from tests.estimator.causes.test_every_cause import SETTING

PAIRS = (("bias-temperature-curve", "bias-temperature"), ("scale-temperature-curve", "scale-temperature"))
"""Parabola and line."""


def found(identifier: str) -> Finding:
    where = scene_for(identifier)
    (finding,) = diagnose(spoilt(identifier, where.measured(1), where, np.random.default_rng(0))).findings
    return finding


@pytest.mark.parametrize("identifier", [name for pair in PAIRS for name in pair])
def test_each_is_named_alone(identifier: str) -> None:
    finding = found(identifier)
    assert (finding.cause, finding.alternatives) == (identifier, ())


@pytest.mark.parametrize(("curve", "line"), PAIRS)
def test_a_bend_that_hardly_shows_leaves_the_line_its_name(curve: str, line: str) -> None:
    where = scene_for(line)
    hidden = change(line, where) + 0.02 * change(curve, where)
    (finding,) = diagnose(with_readings(where.measured(2), hidden * where.world.truth.scale)).findings
    assert (finding.cause, finding.alternatives) == (line, ())


@pytest.mark.parametrize(("temperatures", "shown"), [(3, False), (4, True)])
def test_a_parabola_goes_through_any_three_temperatures(temperatures: int, shown: bool) -> None:
    rows = np.arange(SETTING.rows) % temperatures + 20.0
    for curve, _ in PAIRS:
        assert cause(curve).available(replace(SETTING, temperature=rows)) is shown
