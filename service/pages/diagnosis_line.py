"""A diagnosis in one line, with the tone in which it is said."""

from dataclasses import dataclass

from service.records.diagnosis import DiagnosisState, DiagnosisSummary
from service.words.failed import session_failed

PENDING = "Still being examined"
TONES = {
    DiagnosisState.NOTHING: "pass",
    DiagnosisState.NAMED: "conditional-fail",
    DiagnosisState.UNDECIDED: "undecidable",
    DiagnosisState.UNEXPLAINED: "undecidable",
    DiagnosisState.FAILED: "none",
    DiagnosisState.NOT_APPLICABLE: "none",
}
"""Style and icon, in the tones of the verdicts: how much it asks for attention."""


@dataclass(frozen=True)
class DiagnosisLine:
    """What the simulation gets wrong, in one line."""

    tone: str
    text: str


def diagnosis_line(found: DiagnosisSummary | None, failed: str = "") -> DiagnosisLine:
    """What is known; None while it is still being examined, or where that ``failed``."""
    if found is None and failed:
        return DiagnosisLine(TONES[DiagnosisState.FAILED], session_failed(failed))
    return DiagnosisLine("none", PENDING) if found is None else DiagnosisLine(TONES[found.state], found.summary)
