"""The zero that follows vibration, from a raw log to its name; and where vibration tells nothing."""

from dataclasses import replace

import numpy as np

from estimator import diagnose, read_session
from estimator.causes import CATALOGUE
from estimator.causes.contract import varies
from estimator.session import ACCELEROMETER
from tests.builders import Document, raw_log, true_sensors
from tests.estimator.causes.hiding import scene, spoilt


def shaken_log(rectified: float, seed: int = 0) -> Document:
    """Rests of 4 s, each shaken at random at 0.3 to 30 % of g; A2's zero moves by ``rectified``·w², at once."""
    document = raw_log(4, orientations=24, still=400, sensors=true_sensors(4, bias=1e-2), noise=1e-3)
    rng = np.random.default_rng(seed)
    at = np.array(document["table"]["position"])
    size = np.where(at >= 0, rng.uniform(0.03, 1.0, 24)[at], 0.0)
    for name, along in zip(("A1", "A2", "A3", "A4"), (0.6, 0.5, 0.4, 0.6), strict=True):
        shake = along * size * np.sqrt(2) * np.sin(2 * np.pi * np.arange(len(at)) / 10)
        added = shake + (rectified * shake**2 if name == "A2" else 0.0)
        document["table"][name] = (np.array(document["table"][name]) + 0.12 * added).tolist()
    return document


def test_a_zero_that_follows_the_vibration_of_a_raw_log_is_named_with_its_coefficient() -> None:
    (finding,) = diagnose(read_session(shaken_log(0.02))).findings
    assert (finding.cause, finding.sensors) == ("vibration-rectification", ("A2",))
    assert abs(finding.amplitude[0] - 0.02) < 4 * finding.sigma[0]


def test_a_zero_that_follows_the_vibration_in_a_way_unknown_lives_there() -> None:
    where = scene(ACCELEROMETER, 0)
    session = spoilt("vibration-rectification", where.measured(1), where, np.random.default_rng(1))
    told = diagnose(session, catalogue=[c for c in CATALOGUE if c.identifier != "vibration-rectification"])
    assert told.findings == ()
    assert [s.where for s in told.structures] == ["smooth along the vibration, in no known pattern"]


def test_vibration_alone_is_no_cause() -> None:
    assert diagnose(read_session(shaken_log(0.0))).findings == ()


def test_vibration_that_is_the_same_everywhere_tells_nothing() -> None:
    rng = np.random.default_rng(1)
    assert not varies(1e-3 * (1 + 0.14 * rng.standard_normal((30, 3))))
    assert varies(np.array([[1.0], [1.1], [0.9], [3.0]]))


def test_without_a_record_of_vibration_the_session_says_that_it_is_blind_to_it() -> None:
    where = scene(ACCELEROMETER, 0)
    session = replace(where.measured(1), vibration=None)
    (limit,) = [one for one in diagnose(session).limits if one.cause == "vibration-rectification"]
    assert (limit.amplitude, limit.reason) == (None, "the session lacks vibration")
    (limit,) = [one for one in diagnose(where.measured(1)).limits if one.cause == "vibration-rectification"]
    assert limit.amplitude is not None
