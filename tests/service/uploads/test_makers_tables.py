"""Public files in the layouts of eighteen makers: kinds, units and rate are proposed, with one question at most."""

from collections import Counter

import httpx
import pytest

from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.public_cases import CASES
from tests.service.uploads.test_own_logs import FACTS_OF_EVERY_LOG, fields, previewed

FILES = CASES / "makers-tables" / "files"
ACCELEROMETERS, SIX_AXES = {"accelerometer": 3}, {"accelerometer": 3, "gyroscope": 3}
MAKERS: dict[str, tuple[dict[str, int], set[str], set[str]]] = {
    "actigraph.csv": (ACCELEROMETERS, {"g"}, set()),
    "betaflight.csv": (SIX_AXES, {"count", "°/s"}, set()),
    "euroc.csv": (SIX_AXES, {"m/s²", "rad/s"}, set()),
    "flysight.csv": (SIX_AXES, {"g", "°/s"}, set()),
    "gyro_long.csv": ({"gyroscope": 1}, {"°/s"}, {"sample_rate_hz", "sensors", "sensors[1].nominal_axis"}),
    "imu0.log": (SIX_AXES, {"m/s²", ""}, {"sample_rate_hz"}),
    "kalibr.csv": (SIX_AXES, {"m/s²", "rad/s"}, set()),
    "matrix.mat": (SIX_AXES, {"m/s²", "rad/s"}, set()),
    "mtmanager.txt": (SIX_AXES, {"m/s²", ""}, {"sample_rate_hz"}),
    "phyphox.csv": (ACCELEROMETERS, {"m/s²"}, set()),
    "physicstoolbox.csv": (ACCELEROMETERS, {"g"}, set()),
    "picoquake.csv": (SIX_AXES, {"g", "°/s"}, set()),
    "sensorlogger.csv": (ACCELEROMETERS, {"m/s²"}, set()),
    "shimmer.csv": (SIX_AXES, {"m/s²", "°/s"}, set()),
    "struct.mat": (ACCELEROMETERS, {"m/s²"}, set()),
    "v73.mat": (ACCELEROMETERS, {"m/s²"}, set()),
    "witmotion.txt": (SIX_AXES, {"g", "°/s"}, set()),
    "ximu3.csv": (SIX_AXES, {"g", "°/s"}, set()),
}
"""Kinds, units and questions of makers' files; all of them have 100 Hz."""


@pytest.mark.skipif(not FILES.is_dir(), reason=f"no cases in {CASES}; set IMU_HEALTH_CASES to their folder")
@pytest.mark.parametrize("name", MAKERS)
def test_files_of_makers_ask_one_question_at_most(client: httpx.Client, name: str) -> None:
    found = previewed(client, (FILES / name).read_bytes(), name)
    session, (kinds, units, asked) = found["mapping"]["session"], MAKERS[name]
    assert Counter(sensor["kind"] for sensor in session["sensors"]) == kinds
    assert {sensor["reading_unit"] for sensor in session["sensors"]} == units
    assert fields(found) - FACTS_OF_EVERY_LOG == asked
    assert session["programme"] == "arbitrary-orientations"
    assert ("sample_rate_hz" in asked) or session["sample_rate_hz"] == pytest.approx(100.0)
