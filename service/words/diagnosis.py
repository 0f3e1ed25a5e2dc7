"""Step: a diagnosis as JSON can hold it, what it came to, and that in one line."""

from collections.abc import Sequence
from math import isfinite
from typing import Any

from estimator.diagnosis import Diagnosis, Finding
from service.records.diagnosis import DiagnosisState

NOT_APPLICABLE = (
    "Not applicable to this programme: causes are looked for in calibrations, on a stand or in still orientations."
)
NOTHING = "Nothing wrong found: the simulation explains the readings."
MOST_NAMES = 3
UNEXPLAINED = "Something is there that no known cause explains"


def document_of(diagnosis: Diagnosis) -> dict[str, Any]:
    """imu-diagnosis/1; a number that is not finite becomes null."""
    document: dict[str, Any] = _finite(diagnosis.to_dict())
    return document


def inapplicable(unit: str) -> dict[str, Any]:
    """imu-diagnosis/1 of a session of a programme in which no causes are looked for."""
    empty: dict[str, Any] = {"findings": [], "unexplained": False, "structures": [], "limits": []}
    unmade = dict.fromkeys(("gain", "calibration", "residuals_before"))
    return {"format": "imu-diagnosis/1", "unit": unit, **empty, **unmade, "notes": [NOT_APPLICABLE]}


def _finite(value: Any) -> Any:
    match value:
        case dict():
            return {key: _finite(inner) for key, inner in value.items()}
        case list() | tuple():
            return [_finite(inner) for inner in value]
        case float():
            return value if isfinite(value) else None
        case _:
            return value


def state_of(diagnosis: Diagnosis) -> DiagnosisState:
    """What people hear first: a name, a choice, structure without a name, or nothing."""
    if diagnosis.findings:
        doubtful = bool(diagnosis.findings[0].alternatives)
        return DiagnosisState.UNDECIDED if doubtful else DiagnosisState.NAMED
    return DiagnosisState.UNEXPLAINED if diagnosis.unexplained else DiagnosisState.NOTHING


def summary_of(diagnosis: Diagnosis) -> str:
    """One line that a technician understands."""
    if diagnosis.findings:
        first, *others = diagnosis.findings
        more = [_choice(f) if f.alternatives else f.sentence for f in others[:2]]
        rest = f" And {len(others) - 2} more." if len(others) > 2 else ""
        return " ".join([_choice(first) if first.alternatives else first.sentence, *more]) + rest
    if diagnosis.unexplained:
        first_place = diagnosis.structures[0]
        who = f" in {', '.join(first_place.sensors)}" if first_place.sensors else ", common to all sensors"
        return f"{UNEXPLAINED}{who}: {first_place.where}."
    return NOTHING


def in_words(identifier: str) -> str:
    """``bias temperature`` of ``bias-temperature``."""
    return identifier.replace("-", " ")


def listed(names: Sequence[str]) -> str:
    """``a, b or c``; of many only the first three."""
    if len(names) > MOST_NAMES:
        return f"{', '.join(names[:MOST_NAMES])} or {len(names) - MOST_NAMES} more"
    return f"{', '.join(names[:-1])} or {names[-1]}"


def _choice(finding: Finding) -> str:
    """``Cannot tell which: bias ramp or warm up (A3).``"""
    names = [in_words(identifier) for identifier in (finding.cause, *finding.alternatives)]
    who = f" ({', '.join(finding.sensors)})" if finding.sensors else ""
    return f"Cannot tell which: {listed(names)}{who}."
