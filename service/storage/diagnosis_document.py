"""imu-diagnosis/1: written from what the estimator found, and read back, as this version or an earlier one wrote it."""

import json
from dataclasses import asdict
from math import isfinite, nan
from typing import Any

from estimator.diagnosis import Diagnosis, Finding
from estimator.diagnosis.results import (
    Course,
    Gain,
    Limit,
    NoiseScale,
    OverSessions,
    ParitySplit,
    Rival,
    Score,
    Separation,
    Structure,
    Transfer,
)
from estimator.moments import in_utc
from service.records.diagnosis import Diagnosed
from service.records.model import Evidence, Pooled
from service.storage.calibration_document import calibration_from_dict, residuals_from_dict
from service.storage.json_text import json_text
from service.words.diagnosis import NOT_APPLICABLE


def diagnosis_to_dict(diagnosis: Diagnosis) -> dict[str, Any]:
    """imu-diagnosis/1; a number that is not finite becomes null."""
    document: dict[str, Any] = finite(diagnosis.to_dict())
    return document


def inapplicable_to_dict(unit: str) -> dict[str, Any]:
    """imu-diagnosis/1 of a session of a programme in which no causes are looked for."""
    empty: dict[str, Any] = {"findings": [], "unexplained": False, "structures": [], "limits": [], "noise": []}
    unmade = dict.fromkeys(("gain", "calibration", "residuals_before"))
    return {"format": "imu-diagnosis/1", "unit": unit, **empty, **unmade, "notes": [NOT_APPLICABLE]}


def written(document: dict[str, Any]) -> str:
    """The document as it is stored and handed out."""
    return json_text(document)


def read_diagnosis(text: str) -> Diagnosed | None:
    """What was written, null as NaN; None of a programme in which no causes are looked for."""
    document = json.loads(text)
    if document["gain"] is None:
        return None
    return Diagnosed(
        findings=tuple(_finding(entry) for entry in document["findings"]),
        structures=tuple(_structure(entry) for entry in document.get("structures", ())),
        gain=_gain(document["gain"]),
        limits=tuple(_limit(entry) for entry in document["limits"]),
        noise=tuple(_noise(entry) for entry in document.get("noise", ())),
        notes=tuple(document.get("notes", ())),
        calibration=calibration_from_dict(document["calibration"]),
        residuals_before=residuals_from_dict(document["residuals_before"]),
    )


def evidence_to_dict(evidence: Evidence | None) -> dict[str, Any]:
    """What a model revision rests on; empty of one that withdraws another."""
    return {} if evidence is None else finite(asdict(evidence))


def evidence_from_dict(entry: dict[str, Any]) -> Evidence | None:
    """What `evidence_to_dict` wrote."""
    if not entry:
        return None
    return Evidence(
        p_value=_number(entry["p_value"]),
        strength=_number(entry["strength"]),
        amplitude=_numbers(entry["amplitude"]),
        sigma=_numbers(entry["sigma"]),
        units=tuple(entry["units"]),
        nonlinear=_named(entry["nonlinear"]),
        alternatives=tuple(entry["alternatives"]),
        sentence=entry["sentence"],
        gain=None if entry["gain"] is None else _gain(entry["gain"]),
        pooled=_pooled(entry.get("pooled")),  # absent from earlier versions
    )


def _pooled(entry: dict[str, Any] | None) -> Pooled | None:
    if entry is None:
        return None
    words = tuple(entry.get("words", ()))  # absent from earlier versions
    moments = {name: in_utc(entry[name]) for name in ("first", "last", "since")}
    return Pooled(**entry | moments | {"spread": tuple(entry["spread"]), "words": words})


def finite(value: Any) -> Any:
    """What JSON can hold: a number that is not finite becomes null."""
    match value:
        case dict():
            return {key: finite(inner) for key, inner in value.items()}
        case list() | tuple():
            return [finite(inner) for inner in value]
        case float():
            return value if isfinite(value) else None
        case _:
            return value


def _number(value: float | None) -> float:
    return nan if value is None else value


def _numbers(values: list[float | None]) -> tuple[float, ...]:
    return tuple(map(_number, values))


def _named(values: dict[str, float | None]) -> dict[str, float]:
    return {name: _number(value) for name, value in values.items()}


def _finding(entry: dict[str, Any]) -> Finding:
    return Finding(
        cause=entry["cause"],
        sensors=tuple(entry["sensors"]),
        amplitude=_numbers(entry["amplitude"]),
        sigma=_numbers(entry["sigma"]),
        units=tuple(entry["units"]),
        # Earlier versions stated the shape of the first sensor alone.
        nonlinear_each=tuple(map(_named, entry.get("nonlinear_each") or [entry["nonlinear"]])),
        p_value=_number(entry["p_value"]),
        strength=_number(entry["strength"]),
        alternatives=tuple(entry["alternatives"]),
        separations=tuple(map(_separation, entry["separations"])),
        ranking=tuple(map(_rival, entry["ranking"])),
        sentence=entry["sentence"],
        advice=entry["advice"],
        parity=None if entry["parity"] is None else ParitySplit(**_named(entry["parity"])),
        new=entry["new"],
        over_sessions=_over_sessions(entry.get("over_sessions")),  # absent from earlier versions
    )


def _over_sessions(entry: dict[str, Any] | None) -> OverSessions | None:
    if entry is None:
        return None
    return OverSessions(**entry | {"spread": _numbers(entry["spread"]), "since": in_utc(entry["since"])})


def _separation(entry: dict[str, Any]) -> Separation:
    return Separation(
        cause=entry["cause"],
        sensors=tuple(entry["sensors"]),
        now=_number(entry["separation"]),
        measurement=entry["measurement"],
        then=entry["expected_separation"],
    )


def _rival(entry: dict[str, Any]) -> Rival:
    share, strength = _number(entry["probability"]), _number(entry["strength"])
    return Rival(entry["cause"], tuple(entry["sensors"]), share, strength)


def _structure(entry: dict[str, Any]) -> Structure:
    p_value, strength = _number(entry["p_value"]), _number(entry["strength"])
    course = entry.get("course")  # absent from earlier versions, as is the next
    return Structure(
        where=entry["where"],
        sensors=tuple(entry["sensors"]),
        p_value=p_value,
        strength=strength,
        course=None if course is None else _course(course),
        of_record=entry.get("of_record", False),
    )


def _course(entry: dict[str, Any]) -> Course:
    return Course(entry["order"], tuple(entry["components"]), tuple(map(_numbers, entry["values"])))


def _noise(entry: dict[str, Any]) -> NoiseScale:
    sensors = tuple(entry.get("sensors", ()))
    return NoiseScale(entry["kind"], _number(entry["factor"]), _number(entry["freedom"]), sensors)


def _gain(entry: dict[str, Any]) -> Gain:
    before, after = _score(entry["before"]), _score(entry["after"])
    earlier = entry.get("session")  # absent from earlier versions
    return Gain(before, after, entry["held_out"], None if earlier is None else _transfer(earlier))


def _transfer(entry: dict[str, Any]) -> Transfer:
    return Transfer(in_utc(entry["started_at"]), _score(entry["before"]), _score(entry["after"]))


def _score(entry: dict[str, Any]) -> Score:
    rms, square, score = (_number(entry[name]) for name in ("rms", "chi2_per_dof", "log_score"))
    return Score(rms, square, score, _named(entry.get("rms_by_kind", {})))  # absent from earlier versions


def _limit(entry: dict[str, Any]) -> Limit:
    amplitude = entry["amplitude"]
    return Limit(
        cause=entry["cause"],
        amplitude=None if amplitude is None else _numbers(amplitude),
        units=tuple(entry["units"]),
        reason=entry["reason"],
    )
