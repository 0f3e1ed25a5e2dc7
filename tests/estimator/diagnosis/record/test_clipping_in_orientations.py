"""Clipped channels in arbitrary orientations and in raw logs: named on the right sensor, with an honest limit."""

import numpy as np
import pytest

from estimator import Diagnosis, diagnose, read_session
from estimator.calibration.calibrate import averaged
from estimator.causes import CATALOGUE
from estimator.diagnosis.record.clipping import unclipped
from estimator.diagnosis.record.expected import who_may_misfit
from tests.builders import Array, Document, TrueSensor, arbitrary_orientations, raw_log, true_sensors

SCALE = 0.12
"""V per m/s², of every sensor."""


def measured(m: int, seed: int, *, orientations: int = 24) -> Document:
    sensors = true_sensors(m, bias=5e-2, tilt=2e-3, seed=seed)
    return arbitrary_orientations(m, orientations=orientations, sensors=sensors, seed=seed)


def clipped(document: Document, sensor: str, rows: int, side: float) -> float:
    """Clips a sensor so that as many rows lie beyond its limit on a side, and returns the limit in m/s²."""
    u = side * np.array(document["table"][sensor])
    highest = np.sort(u)[::-1]
    limit = (highest[rows - 1] + highest[rows]) / 2
    document["table"][sensor] = [float(x) for x in side * np.minimum(u, limit)]
    return float(limit / SCALE)


def named(found: Diagnosis) -> list[tuple[str, tuple[str, ...]]]:
    return [(f.cause, f.sensors) for f in found.findings]


@pytest.mark.slow
@pytest.mark.parametrize("m", [3, 4, 6])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_clipped_sensor_is_named_with_its_limit(m: int, side: float) -> None:
    for seed in range(2):
        document = measured(m, seed)
        limit = clipped(document, "A2", 2 + seed % 3, side)
        found = diagnose(read_session(document))
        assert named(found) == [("saturation", ("A2",))]
        assert not found.unexplained
        assert abs(found.findings[0].amplitude[0] - abs(limit)) < 4 * found.findings[0].sigma[0]


@pytest.mark.parametrize("m", [3, 6])
def test_one_clipped_row_is_as_well_a_reading_that_does_not_belong(m: int) -> None:
    document = measured(m, 1)
    limit = clipped(document, "A2", 1, 1.0)
    (finding,) = diagnose(read_session(document)).findings
    assert (finding.cause, finding.sensors, finding.alternatives) == ("saturation", ("A2",), ("reading-outlier",))
    assert sum(rival.probability for rival in finding.ranking) == pytest.approx(1)
    assert abs(finding.amplitude[0] - limit) < 4 * finding.sigma[0]


def test_the_other_parameters_are_those_of_the_session_without_clipping() -> None:
    whole, cut = measured(4, 3), measured(4, 3)
    clipped(cut, "A2", 3, 1.0)
    before, after = (diagnose(read_session(document)).calibration for document in (whole, cut))
    for a, b in zip(before.sensors, after.sensors, strict=True):
        assert abs(a.bias.value - b.bias.value) < 3 * b.bias.sigma


@pytest.mark.slow
@pytest.mark.parametrize("m", [3, 4, 6])
def test_sound_sessions_have_no_clipped_sensor_however_coarse(m: int) -> None:
    for seed in range(12):
        document = measured(m, seed)
        step = 3e-6 * 4.0 ** (seed % 4)
        for k in range(m):
            u = np.array(document["table"][f"A{k + 1}"])
            document["table"][f"A{k + 1}"] = [float(x) for x in np.round(u / step) * step]
        assert unclipped(read_session(document), CATALOGUE)[0] == []


def test_a_reading_that_is_too_large_is_no_clipping() -> None:
    document = measured(4, 2)
    u = document["table"]["A2"]
    u[int(np.argmax(u))] += 0.01
    assert "saturation" not in {finding.cause for finding in diagnose(read_session(document)).findings}


def cut_log(beyond: float) -> tuple[Document, Array]:
    """A raw log of rests of 4 s whose A2 is clipped so much above its third highest rest, in sigmas of a sample."""
    sensors = true_sensors(4, bias=5e-2, tilt=2e-3)
    document = raw_log(4, orientations=24, still=400, sensors=sensors, noise=1e-3)
    u, at = np.array(document["table"]["A2"]), np.array(document["table"]["position"])
    means = np.array([u[at == k].mean() for k in range(24)])
    document["table"]["A2"] = [float(x) for x in np.minimum(u, np.sort(means)[-3] + beyond * 1e-3)]
    return document, means


def test_rows_of_a_raw_log_that_are_clipped_in_part_are_left_out_too() -> None:
    document, means = cut_log(beyond=0.0)
    clips, right = unclipped(averaged(read_session(document)), CATALOGUE)
    assert [(clip.sensor, clip.side, len(clip.rows)) for clip in clips] == [(1, 1.0, 3)]
    top = np.argsort(means)[-3:]
    np.testing.assert_allclose(right.readings[top, 1], means[top], atol=5e-4)


def test_samples_at_the_end_of_the_range_are_counted_row_by_row() -> None:
    document, means = cut_log(beyond=0.0)
    share = averaged(read_session(document)).at_ends[:, 1, 0]
    order = np.argsort(means)
    assert share[order[-1]] == 1.0
    assert 0.3 < share[order[-3]] < 0.7
    assert np.all(share[order[:-6]] == 0.0)


def test_of_many_sensors_one_clipped_far_beyond_is_still_found() -> None:
    document = measured(12, 3)
    clipped(document, "A2", 2, 1.0)
    session = read_session(document)
    assert who_may_misfit(session) == [0, 1, 2]
    assert ("saturation", ("A2",)) in named(diagnose(session))


def test_where_neither_half_fits_no_single_sensor_is_at_fault() -> None:
    document = measured(12, 4)
    for sensor in ("A1", "A2", "A5", "A6"):  # two of each half
        document["table"][sensor] = [u + 0.02 * SCALE * k for k, u in enumerate(document["table"][sensor])]
    assert who_may_misfit(read_session(document)) == []


@pytest.mark.parametrize("m", [6, 12])
def test_of_sensors_that_fit_none_is_ruled_out(m: int) -> None:
    assert sorted(who_may_misfit(read_session(measured(m, 5)))) == list(range(m))


@pytest.mark.parametrize("second", ["yxz", "xyx"])
def test_a_board_of_triads_is_halved_whether_or_not_its_halves_span_space(second: str) -> None:
    """Every second sensor in a board of eight IMUs lies in a plane, whose shape is singular."""
    axes = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
    board = [TrueSensor(f"A{k + 1}", axes[letter], bias=0.05) for k, letter in enumerate(2 * ("xyz" + second))]
    document = arbitrary_orientations(sensors=board)
    for sensor, true in zip(document["sensors"], board, strict=True):
        sensor["nominal_axis"] = list(true.axis)
    assert sorted(who_may_misfit(read_session(document))) == list(range(12))
