"""The schema of a session file names what the reader knows, and no file that can be read breaks it."""

import json
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from estimator.reading import keys
from service.sessions.schema import SENSOR, SESSION_FILE, SITE, STAND, TABLE
from tests.builders import accelerometer_block, arbitrary_orientations, gyro_block, mixed_block, raw_log
from tests.estimator.test_reading_docs import example

SCHEMA = Draft202012Validator(SESSION_FILE)
SESSIONS = {
    "of-the-page": lambda: json.loads(example("json")),
    "accelerometers": accelerometer_block,
    "gyros": gyro_block,
    "both": mixed_block,
    "orientations": arbitrary_orientations,
    "log": raw_log,
}


@pytest.mark.parametrize("made", SESSIONS.values(), ids=SESSIONS)
def test_a_session_that_can_be_read_keeps_the_schema(made: Any) -> None:
    SCHEMA.validate(made())


@pytest.mark.parametrize(
    ("schema", "known"),
    [
        (SESSION_FILE, keys.TOP),
        (SITE, keys.SITE),
        (STAND, keys.STAND),
        (SENSOR, keys.SENSOR),
        (TABLE, keys.COLUMNS),
    ],
    ids=["top", "site", "stand", "sensor", "table"],
)
def test_the_schema_names_what_the_reader_knows(schema: dict[str, Any], known: Any) -> None:
    assert set(schema["properties"]) == set(known)


def test_what_is_left_out_may_be_null() -> None:
    document = accelerometer_block()
    document["site"]["height_m"] = None
    document["table"]["temperature_c"] = None
    SCHEMA.validate(document)


@pytest.mark.parametrize("broken", [{"sensors": []}, {"format": "imu-session/2"}, {"block": "magnetometer"}])
def test_a_session_that_cannot_be_read_breaks_it(broken: dict[str, Any]) -> None:
    assert not SCHEMA.is_valid(accelerometer_block() | broken)
