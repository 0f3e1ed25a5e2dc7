"""Steps: files in which something went wrong before they came in, at any moment of a unit's life."""

import json
from dataclasses import replace
from datetime import UTC, datetime, timedelta, timezone
from functools import cache
from typing import Any
from urllib.parse import quote

import numpy as np
from hypothesis import strategies as st
from hypothesis.stateful import rule

from estimator import Calibration, SessionError, calibrate, read_session
from estimator.results import Estimate, SensorCalibration
from tests.lives.generator.faults import FAILURES, SICKNESSES, SLIPS, failing, gross, hot, in_counts, scaled, sick
from tests.lives.quiet import state, wait_until_quiet
from tests.lives.steps import BY, NUMBERS
from tests.lives.units import Document
from tests.lives.uploads import Uploads

TABLED = ("LV-101", "LV-102", "LV-240", "LV-350", "HM-460", "MX-890")
"""Units that are measured on a stand, or by hand in orientations."""
LOGGED, FLOWN = "LG-680", "FL-790"
DRAWN = st.integers(0, 2**32 - 1)
WITHIN = 3.0
"""Standard uncertainties of a sound file's figures within which those of a faulty one lie: as many readings are left
but for a few, so that they scatter from each other by far less."""


class Faults(Uploads):
    """Faults of measuring and recording."""

    @rule(serial=st.sampled_from(TABLED), number=NUMBERS, slip=st.sampled_from(list(SLIPS)), drawn=DRAWN)
    def sends_a_gross_reading(self, serial: str, number: int, slip: str, drawn: int) -> None:
        """A reading that was copied wrong, or a channel that hung for some rows."""
        document = self.measured(serial, number)
        made = gross(document, slip, np.random.default_rng(drawn))
        receipt = self.upload(_bytes(made.document), "gross.json")
        self.holds_as(document, receipt, f"{serial}-{number} with {slip} at {made.sensor}, rows {made.rows}")

    @rule(number=NUMBERS, sickness=st.sampled_from(list(SICKNESSES)), labelled=st.booleans(), drawn=DRAWN)
    def sends_a_sick_log(self, number: int, sickness: str, labelled: bool, drawn: int) -> None:
        """A raw file as a poor logger writes it."""
        document = self.measured(LOGGED, number)
        if not labelled:
            del document["table"]["position"]
        receipt = self.upload(_bytes(sick(document, sickness, np.random.default_rng(drawn))), "log.json")
        self.holds_as(in_counts(document), receipt, f"{LOGGED}-{number} with {sickness}")

    @rule(serial=st.sampled_from(TABLED), number=NUMBERS, factor=st.sampled_from([1.01, 1.05, 1.5, 0.9]))
    def sets_a_wrong_range(self, serial: str, number: int, factor: float) -> None:
        """No unit passes that reads all by so much more, unless it did so before."""
        before = self.world.rescaled.copy()
        receipt = self.upload(_bytes(scaled(self.measured(serial, number), factor)), "range.json")
        if receipt is None or receipt["unit"] in before or self._widest(receipt["unit"]) > abs(factor - 1) / 2:
            return
        self.world.rescaled.add(receipt["unit"])
        self.expect(receipt["verdict"] != "pass", f"{serial}-{number} × {factor} passes: {receipt['reason']}")

    @rule(serial=st.sampled_from(TABLED), number=NUMBERS, hours=st.sampled_from([3.0, 5.5, -9.5]))
    def writes_the_time_of_the_place(self, serial: str, number: int, hours: float) -> None:
        """It is the same moment."""
        document = self.measured(serial, number)
        if "started_at" not in document:
            return
        at = datetime.fromisoformat(document["started_at"])
        document["started_at"] = at.astimezone(timezone(timedelta(hours=hours))).isoformat()
        if receipt := self.upload(_bytes(document), "local.json"):
            known = datetime.fromisoformat(self.world.get(f"/sessions/{receipt['id']}")["started_at"])
            self.expect(known.astimezone(UTC) == at.astimezone(UTC), f"{document['started_at']} became {known}")

    @rule(number=NUMBERS, failure=st.sampled_from(list(FAILURES)), drawn=DRAWN, stays=st.booleans())
    def records_a_failure(self, number: int, failure: str, drawn: int, stays: bool) -> None:
        """A sensor that fails while the unit is in use: the unit is unfit, and is as before once that is taken back."""
        before = self._known() if not stays and not self.world.is_short else None
        document, sensor = failing(self._recording(number), failure, np.random.default_rng(drawn))
        receipt = self.upload(_bytes(document), "failing.json")
        if receipt is None or not receipt["created"] or receipt["state"] != "accepted":
            return
        said = f"{failure} of {sensor} in {receipt['id']}"
        self.expect(receipt["verdict"] == "fail" and sensor in receipt["reason"], f"{said}: {receipt['reason']}")
        usable = self.world.get(f"/units/{FLOWN}/usable")
        self.expect(not usable["usable"], f"{said}: the unit may be used: {usable['why']}")
        if usable["session"] == receipt["id"] and usable["answer"] == "no":
            self.expect(sensor in usable["why"], f"{said}: {usable['why']}")
        if not stays:
            self.tries(f"/sessions/{receipt['id']}/withdraw", BY)
            self.expect(before is None or self._known() == before, f"{said}: the unit is not as it was before it")

    @rule(number=NUMBERS, by=st.sampled_from([25.0, 45.0]), drawn=DRAWN)
    def records_in_the_heat(self, number: int, by: float, drawn: int) -> None:
        """Biases that follow the temperature are no failure of a sensor, and nothing that a verdict may pass."""
        document = hot(self._recording(number), by, np.random.default_rng(drawn))
        receipt = self.upload(_bytes(document), "hot.json")
        if receipt and receipt["created"] and receipt["state"] == "accepted":
            found = self.world.get(f"/sessions/{receipt['id']}")
            self.expect(found["verdict"] != "pass", f"{receipt['id']} at {20 + by} °C passes: {found['reason']}")

    def holds_as(self, sound: Document, receipt: dict[str, Any] | None, what: str) -> None:
        """A faulty file that counts says what the sound one says."""
        if receipt is None or receipt["state"] != "accepted" or self.world.listed("models"):
            return
        right = calibration(json.dumps(sound))
        if right is None:
            return
        path = f"/units/{quote(receipt['unit'], safe='')}/history"
        for point in self.world.get(path, params={"limit": 10000})["points"]:
            if point["session"] == receipt["id"] and point["sensor"] in {sensor.name for sensor in right.sensors}:
                sensor = right.sensor(point["sensor"])
                by = off(recorded(point, sensor), sensor, point["parameter"])
                self.expect(by <= WITHIN, f"{what}: {point['sensor']} {point['parameter']} is off by {by:.1f} u")

    def _recording(self, number: int) -> Document:
        """A recording in service."""
        made = self.world.benches[FLOWN].programmes["in-service"](number - number % 3)  # every third has moved
        return dict(json.loads(json.dumps(made)))

    def _known(self) -> Any:
        wait_until_quiet(self.world)
        return state(self.world).get(FLOWN)

    def _widest(self, unit: str) -> float:
        """Relative tolerance of a scale factor, the widest of the unit's type."""
        name = self.world.get(f"/units/{quote(unit, safe='')}")["summary"]["unit_type"]
        kind = next(one for one in self.world.listed("unit-types") if one["name"] == name)
        return max((kind[of]["scale"] or 0.0) for of in ("tolerances", "gyro_tolerances") if kind[of])


def _bytes(document: Document) -> bytes:
    return json.dumps(document).encode()


@cache
def calibration(document: str) -> Calibration | None:
    """Calibration of a sound file; None where it supports none."""
    try:
        return calibrate(read_session(json.loads(document)))
    except SessionError:
        return None


def off(found: SensorCalibration, right: SensorCalibration, parameter: str) -> float:
    """Standard uncertainties of the right one by which a parameter is not that; 0 where either is unknown."""
    if parameter == "axis":
        if found.axis is None or right.axis is None:
            return 0.0
        away = np.linalg.norm(np.cross(right.axis, found.axis))
        return float(away / np.sqrt(np.trace(right.axis_covariance)))
    one, other = getattr(found, parameter), getattr(right, parameter)
    if one.value is None or other.value is None or not other.sigma:
        return 0.0
    return float(abs(one.value - other.value) / other.sigma)


def recorded(point: dict[str, Any], like: SensorCalibration) -> SensorCalibration:
    """A sensor with one parameter as it is on record."""
    if point["parameter"] == "axis":
        return replace(like, axis=None if point["axis"] is None else np.array(point["axis"]))
    return replace(like, **{point["parameter"]: Estimate(point["value"], point["u"])})
