"""imu-diagnosis/1: written from what the estimator found, and read back, as this version or an earlier one wrote it."""

import json
from typing import Any

from service.records.diagnosis import Diagnosed
from service.records.model import Evidence
from service.storage.documents import STORED
from service.words.diagnosis import NOT_APPLICABLE


def inapplicable_to_dict(unit: str) -> dict[str, Any]:
    """imu-diagnosis/1 of a session of a programme in which no causes are looked for."""
    empty: dict[str, Any] = {"findings": [], "unexplained": False, "structures": [], "limits": [], "noise": []}
    unmade = dict.fromkeys(("gain", "calibration", "residuals_before"))
    return {"format": "imu-diagnosis/1", "unit": unit, **empty, **unmade, "notes": [NOT_APPLICABLE]}


def read_diagnosis(text: str) -> Diagnosed | None:
    """What was written, null as NaN; None of a programme in which no causes are looked for."""
    document = json.loads(text)
    return None if document["gain"] is None else Diagnosed.from_dict(document)


def evidence_to_dict(evidence: Evidence | None) -> dict[str, Any]:
    """What a model revision rests on; empty of one that withdraws another."""
    return {} if evidence is None else STORED.written(evidence)


def evidence_from_dict(entry: dict[str, Any]) -> Evidence | None:
    """What `evidence_to_dict` wrote."""
    return STORED.read(Evidence, entry) if entry else None
