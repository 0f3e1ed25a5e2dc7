"""A diagnosis in words: what it came to in one line, at the head of a page, and what to do about it."""

from collections.abc import Sequence

from estimator.diagnosis import Diagnosis, Finding
from estimator.diagnosis.results import Structure
from estimator.errors import SessionError
from service.records.diagnosis import DiagnosisState
from service.words.causes import what_is_wrong

NOT_APPLICABLE = (
    "Not applicable to this programme: causes are looked for in calibrations, on a stand or in still orientations."
)
NOTHING = "Nothing wrong found: the simulation explains the readings."
UNEXPLAINED = "Something is there that no known cause explains"
MOST_FINDINGS = 3
"""Findings that one line tells before it counts the rest."""
HEADLINES = {
    DiagnosisState.NOTHING: "Nothing wrong found",
    DiagnosisState.UNEXPLAINED: UNEXPLAINED,
    DiagnosisState.FAILED: "This session could not be diagnosed",
    DiagnosisState.NOT_APPLICABLE: "Not applicable to this programme",
}
"""Where no cause is named."""
WHAT_TO_DO = {
    DiagnosisState.NOTHING: (
        "Measurement and simulation agree within the noise: no cause of the catalogue and no other structure shows."
    ),
    DiagnosisState.UNDECIDED: (
        "This session cannot distinguish these causes. Take the measurement that can, before you act on one of them."
    ),
    DiagnosisState.UNEXPLAINED: (
        "Do not force a name on it: look where it lives, repeat the session, and compare with another unit or stand."
    ),
}
"""Where no cause is named; a named one brings its own advice."""


def summary_of(diagnosis: Diagnosis) -> str:
    """One line that a technician understands."""
    if diagnosis.findings:
        told, more = diagnosis.findings[:MOST_FINDINGS], len(diagnosis.findings) - MOST_FINDINGS
        return " ".join(map(what_is_wrong, told)) + (f" And {more} more." if more > 0 else "")
    if diagnosis.structures:
        first = diagnosis.structures[0]
        who = f" in {', '.join(first.sensors)}" if first.sensors else ", common to all sensors"
        return f"{UNEXPLAINED}{who}: {first.where}."
    return NOTHING


def cannot_be_diagnosed(fault: SessionError) -> str:
    """What the session lacks."""
    return f"The session cannot be diagnosed: {fault}"


def fault_of_the_program(session: str) -> str:
    """That the program failed, and what holds all the same."""
    return (
        "The program failed at this diagnosis: that is a fault of the program, not of the session. The session, its "
        "calibration and its verdict are stored and hold, and the next version of the program diagnoses it again. "
        f"The log says what happened, under session {session}: send that to those who maintain the program."
    )


def unexplained_in(structures: Sequence[Structure]) -> str:
    """That something is there, and in which sensors."""
    sensors = sorted({sensor for structure in structures for sensor in structure.sensors})
    return f"{UNEXPLAINED}{' in ' + ', '.join(sensors) if sensors else ''}."


def headline(state: DiagnosisState, findings: Sequence[Finding]) -> str:
    """The first cause or the choice that cannot be made; without one what the diagnosis came to."""
    return what_is_wrong(findings[0]) if findings else HEADLINES[state]


def what_to_do(state: DiagnosisState, findings: Sequence[Finding]) -> str:
    """What a technician does next."""
    return findings[0].advice if state is DiagnosisState.NAMED else WHAT_TO_DO[state]
