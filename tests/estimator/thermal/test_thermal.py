"""Curves over temperature against sessions whose truth another simulator knows."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.thermal import CASES, GRID, Case, Tally, Truth, at, bound, compared, draw, knows_quadratic
from estimator import Calibration, ScheduleError, calibrate, read_session
from estimator.correction import at_temperature
from estimator.curves import HYSTERESIS, MISFIT
from estimator.json_object import Json
from estimator.session import Array

PLAIN, UNSTATED, FACES, GYROS, _, LOOP, SLOW, WAVE = CASES
FEW = 6
"""Sessions of a case: 72 curves."""


def results(case: Case, count: int = FEW) -> list[tuple[Calibration, Truth]]:
    rng = np.random.default_rng([7, *case.name.encode()])
    drawn = [draw(case, rng) for _ in range(count)]
    return [(calibrate(read_session(document)), truth) for document, truth in drawn]


@pytest.fixture(scope="module")
def plain() -> list[tuple[Calibration, Truth]]:
    return results(PLAIN)


def tally_of(made: list[tuple[Calibration, Truth]]) -> tuple[Tally, Array]:
    tally = Tally()
    return tally, np.array([compared(result, truth, tally) for result, truth in made])


@pytest.mark.slow
@pytest.mark.parametrize("case", [UNSTATED, FACES, GYROS], ids=lambda case: case.name)
def test_the_bands_hold_the_true_curves(case: Case) -> None:
    """Expected 95 % with a standard error of about 2 %, since a curve counts as one figure."""
    tally, _ = tally_of(results(case))
    assert 0.89 < np.mean(tally.held) < 0.995
    assert np.mean(tally.right) > 0.85


def test_errors_are_those_of_the_cramer_rao_bound(plain: list[tuple[Calibration, Truth]]) -> None:
    tally, squares = tally_of(plain)
    bounds = np.array([bound(PLAIN, truth, quadratic=knows_quadratic(result)) for result, truth in plain])
    assert 0.7 < np.mean(squares / bounds) < 1.4
    assert np.mean(tally.right) > 0.85
    assert 0.89 < np.mean(tally.held) < 0.995


def test_a_sound_session_shows_nothing_beside_its_curves(plain: list[tuple[Calibration, Truth]]) -> None:
    assert [result.thermal.findings for result, _ in plain if result.thermal] == [()] * FEW


def test_the_calibration_is_the_curve_at_the_reference_temperature(plain: list[tuple[Calibration, Truth]]) -> None:
    result, truth = plain[0]
    curves, sensor = result.thermal, result.sensor("A1")
    assert curves is not None
    assert curves.reference_temperature == 20.0
    assert sensor.bias.value == pytest.approx(curves.sensor("A1").bias.coefficients[0])
    assert sensor.scale.value is not None
    assert sensor.scale.sigma is not None
    assert abs(sensor.scale.value - truth.scale[0][0]) < 4 * sensor.scale.sigma


def test_the_calibration_can_be_moved_to_a_temperature(plain: list[tuple[Calibration, Truth]]) -> None:
    result, truth = plain[0]
    moved = at_temperature(result, 70.0).sensor("A2")
    assert moved.bias.value == pytest.approx(float(at(truth.bias[1], np.array(70.0))), abs=4 * (moved.bias.sigma or 0))
    assert moved.bias.value != pytest.approx(result.sensor("A2").bias.value, abs=1e-3)


def test_the_result_is_read_back_as_it_was_written(plain: list[tuple[Calibration, Truth]]) -> None:
    result, _ = plain[0]
    again = Calibration.from_dict(result.to_dict())
    assert again.to_dict() == result.to_dict()
    assert again.thermal is not None


def test_hysteresis_is_named_with_its_width() -> None:
    for result, _ in results(LOOP, 2):
        assert result.thermal is not None
        assert {(f.kind, f.sensor) for f in result.thermal.findings} == {(HYSTERESIS, f"A{i}") for i in range(1, 7)}
        for found in result.thermal.findings:
            assert found.amplitude == pytest.approx(LOOP.loop * 9.81, abs=4 * found.sigma)


def test_a_wave_that_no_polynomial_follows_is_named_and_widens_the_band() -> None:
    [(sound, _)], [(result, _)] = results(SLOW, 1), results(WAVE, 1)
    assert sound.thermal is not None
    assert result.thermal is not None
    assert MISFIT in {f.kind for f in result.thermal.findings}
    curve, plain_curve = result.thermal.sensor("A1").bias, sound.thermal.sensor("A1").bias
    assert (result.thermal.sigma(curve, GRID) > 2 * sound.thermal.sigma(plain_curve, GRID)).all()


def document() -> Json:
    return draw(replace(PLAIN, each=3), np.random.default_rng(3))[0]


def test_temperatures_are_needed() -> None:
    session = document()
    del session["table"]["temperature_c"]
    with pytest.raises(ValueError, match="temperature_c"):
        read_session(session)


def test_a_narrow_range_shows_no_curve() -> None:
    session = document()
    session["table"]["temperature_c"] = np.linspace(20, 24, len(session["table"]["time_s"])).tolist()
    with pytest.raises(ScheduleError, match="needs 10 °C or more"):
        calibrate(read_session(session))


def test_rows_that_are_measured_without_touching_the_block_share_a_setting() -> None:
    """Six faces, each along a whole course of temperature: the turn of a face is known from all its rows."""
    case = replace(PLAIN, soaks=(20.0, -40.0, 0.0, 40.0, 70.0), each=6, faces=2e-3)
    rng = np.random.default_rng(4)
    document, _ = draw(case, rng)
    alone = calibrate(read_session(document))
    order = np.argsort(np.arange(30) % 6, kind="stable")
    table = {name: np.array(column)[order].tolist() for name, column in document["table"].items()}
    table["time_s"] = document["table"]["time_s"]
    together = document | {"table": table | {"position": np.sort(np.arange(30) % 6).tolist()}}
    shared = calibrate(read_session(together))
    assert shared.fit.dof == alone.fit.dof  # a known direction less is two unknown turns less
