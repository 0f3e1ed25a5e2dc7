"""Public files in the layouts of eighteen makers: kinds, units and rate are proposed, with one question at most."""

import json
from collections import Counter

import httpx
import pytest

from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.public_cases import CASES
from tests.service.uploads.test_layouts_page import faults, sent, shown

FILES = CASES / "makers-tables" / "files"
ACCELEROMETERS, SIX_AXES = {"accelerometer": 3}, {"accelerometer": 3, "gyroscope": 3}
MAKERS: dict[str, tuple[dict[str, int], set[str], set[str]]] = {
    "actigraph.csv": (ACCELEROMETERS, {"g"}, set()),
    "betaflight.csv": (SIX_AXES, {"count", "°/s"}, set()),
    "euroc.csv": (SIX_AXES, {"m/s²", "rad/s"}, set()),
    "flysight.csv": (SIX_AXES, {"g", "°/s"}, set()),
    "gyro_long.csv": ({"gyroscope": 1}, {"°/s"}, {"sample_rate_hz", "sensors", "sensors[1].nominal_axis"}),
    "imu0.log": (SIX_AXES, {"m/s²", "rad/s"}, {"sample_rate_hz"}),
    "kalibr.csv": (SIX_AXES, {"m/s²", "rad/s"}, set()),
    "matrix.mat": (SIX_AXES, {"m/s²", "rad/s"}, set()),
    "mtmanager.txt": (SIX_AXES, {"m/s²", "rad/s"}, {"sample_rate_hz"}),
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
"""Kinds, units once everything is answered, and questions of makers' files; all of them have 100 Hz."""


WITHOUT_A_BLOCK = "gyro_long.csv"
"""One gyro, which is no block of sensors."""
ANSWERS = {"fact.unit": "M-1", "fact.day": "2026-03-01", "fact.site.latitude_deg": "55.8"}
"""Facts that no log states."""
needs_cases = pytest.mark.skipif(
    not FILES.is_dir(), reason=f"no cases in {CASES}; set IMU_HEALTH_CASES to their folder"
)


@needs_cases
@pytest.mark.parametrize("name", MAKERS)
def test_files_of_makers_are_stored_by_the_page_with_one_question_at_most(client: httpx.Client, name: str) -> None:
    card = client.post("/upload", files={"files": (name, (FILES / name).read_bytes())}).text
    page = shown(card)
    first = sent(client, {key: page[key] for key in ("filename", "content", "aside") if key in page})
    kinds, units, asked = MAKERS[name]
    rate = {"fact.sample_rate_hz": "100"} if "sample_rate_hz" in asked else {}
    looked = sent(client, shown(first.text), **ANSWERS, **rate, do="look")
    fields = shown(looked.text)
    session = json.loads(fields["mapping"])["session"]
    assert Counter(sensor["kind"] for sensor in session["sensors"]) == kinds
    assert {sensor["reading_unit"] for sensor in session["sensors"]} == units
    assert (session["programme"], session["sample_rate_hz"]) == ("arbitrary-orientations", pytest.approx(100.0))
    assert len(asked) <= 1 or name == WITHOUT_A_BLOCK
    stored = sent(client, fields, do="store")
    assert (stored.status_code == 303) != (name == WITHOUT_A_BLOCK), faults(stored.text)
