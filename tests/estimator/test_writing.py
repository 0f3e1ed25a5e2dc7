"""A session written as a document and read back is the same session."""

import json
from dataclasses import fields
from typing import Any

import numpy as np
import pytest

from estimator.reading import read_session
from estimator.session import CalibrationSession
from estimator.writing import session_document
from tests import builders


def placed(document: builders.Document) -> builders.Document:
    """The document with sensors that sit somewhere."""
    sensors = [s | {"position_m": [0.01 * k, -0.02, 0.03]} for k, s in enumerate(document["sensors"])]
    return document | {"sensors": sensors}


DOCUMENTS = {
    "accelerometers": builders.accelerometer_block(mounting=np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]])),
    "pulse gyros": builders.gyro_block(),
    "rate gyros": builders.gyro_block(count_time_s=None),
    "both kinds": builders.mixed_block(),
    "orientations": builders.arbitrary_orientations(direction_sigma_deg=1.0),
    "no standard errors": builders.arbitrary_orientations(se=None),
    "raw log": builders.raw_log(),
    "a counter that is reset": builders.gyro_block() | {"counter": "reset"},
    "simulated": builders.accelerometer_block() | {"origin": "simulated"},
    "switched on before": builders.accelerometer_block() | {"powered_on_at": "2026-03-01T08:20:00.5Z"},
    "switched on with the first row": builders.raw_log() | {"time_since_power_on_s": 0.0},
    "positions": placed(builders.accelerometer_block()),
}


def assert_same(left: Any, right: Any, place: str) -> None:
    """Equal; angles that went through degrees to 1e-12."""
    if isinstance(left, np.ndarray | float):
        np.testing.assert_allclose(right, left, rtol=1e-12, atol=1e-12, err_msg=place)
    elif isinstance(left, tuple):
        for number, (a, b) in enumerate(zip(left, right, strict=True)):
            assert_same(a, b, f"{place}[{number}]")
    elif hasattr(left, "__dataclass_fields__"):
        for f in fields(left):
            assert_same(getattr(left, f.name), getattr(right, f.name), f"{place}.{f.name}")
    else:
        assert left == right, place


@pytest.mark.parametrize("kind", DOCUMENTS)
def test_a_session_survives_writing_and_reading(kind: str) -> None:
    session: CalibrationSession = read_session(DOCUMENTS[kind])
    written = json.loads(json.dumps(session_document(session), allow_nan=False))
    assert_same(session, read_session(written), kind)


def test_angles_are_written_without_rounding_noise() -> None:
    document = builders.accelerometer_block(positions=36)
    written = session_document(read_session(document))
    assert written["table"]["beta_deg"] == document["table"]["beta_deg"]
    assert written["stand"] == document["stand"]
