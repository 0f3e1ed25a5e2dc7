"""imu-diagnosis/1: written from what the estimator found, and read back, as this version or an earlier one wrote it."""

import json
from typing import Any

from service.diagnosis.records import Diagnosed
from service.diagnosis.words.diagnosis import NOT_APPLICABLE


def inapplicable_to_dict(unit: str) -> dict[str, Any]:
    """imu-diagnosis/1 of a session of a programme in which no causes are looked for."""
    empty: dict[str, Any] = {"findings": [], "unexplained": False, "structures": [], "limits": [], "noise": []}
    unmade = dict.fromkeys(("gain", "calibration", "residuals_before"))
    return {"format": "imu-diagnosis/1", "unit": unit, **empty, **unmade, "notes": [NOT_APPLICABLE]}


def read_diagnosis(text: str) -> Diagnosed | None:
    """What was written, null as NaN; None of a programme in which no causes are looked for."""
    document = json.loads(text)
    return None if document["gain"] is None else Diagnosed.from_dict(document)
