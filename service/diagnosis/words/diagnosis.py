"""A diagnosis in words: what it came to in one line, at the head of a page, and what to do about it."""

from collections.abc import Sequence
from typing import Protocol

from estimator.diagnosis import Finding
from estimator.diagnosis.results import NoiseScale, Structure
from estimator.errors import SessionError
from estimator.message import joined, say
from estimator.results import Calibration
from service.diagnosis.words.causes import ONE_NOT_KNOWN, at_once_with, is_level, is_lone, what_is_wrong
from service.diagnosis.words.structures import UNEXPLAINED, headline_of, told, what_to_do_about
from service.sessions.records import DiagnosisState
from service.sessions.words.advice import too_few
from service.sessions.words.noise_claims import but_wrong_errors, wrong_errors

NOT_APPLICABLE = (
    "Not applicable to this programme: causes are looked for in calibrations, on a stand or in still orientations, and "
    "in alignments on a turntable."
)
NOTHING = "Nothing wrong found"
NOTHING_LEFT = "Too few positions to judge the simulation"
TAKEN_UP = "The parameters take all that the readings tell, and nothing is left to find a cause by: add positions."
MOST_FINDINGS = 3
"""Findings that one line tells before it counts the rest."""
HEADLINES = {
    DiagnosisState.NOTHING: NOTHING,
    DiagnosisState.UNEXPLAINED: UNEXPLAINED,
    DiagnosisState.FAILED: "This session could not be diagnosed",
    DiagnosisState.NOT_APPLICABLE: "Not applicable to this programme",
}
"""Where the answer itself is not at hand."""
STILL_MADE = "The diagnosis that this rests on is still being made: ask again in some seconds."
AGREE = "Measurement and simulation agree within the noise: no cause of the catalogue and no other structure shows."
RESTATE = (
    "No cause of the catalogue and no other structure shows. But the readings scatter otherwise than the file says: "
    "correct the standard errors that it states."
)
CHOOSE = "This session cannot distinguish these causes. Take the measurement that can, before you act on one of them."
RULE_OUT = "This session does not rule the less likely causes out. Take the measurement that would, before you act."
REPEAT = say(
    "One known cause explains it, and {one_not_known} would as well. Repeat the session "
    "before you act: if the name is right, it comes back.",
    one_not_known=ONE_NOT_KNOWN,
)
REPEAT_BOTH = say(
    "Two causes at once on one sensor are rare, and {one_not_known} would explain it as "
    "well. Repeat the session before you act: if the names are right, both come back.",
    one_not_known=ONE_NOT_KNOWN,
)


class Answer(Protocol):
    """What a diagnosis came to, as it was made or as it is stored."""

    @property
    def findings(self) -> tuple[Finding, ...]: ...
    @property
    def structures(self) -> tuple[Structure, ...]: ...
    @property
    def noise(self) -> tuple[NoiseScale, ...]: ...
    @property
    def calibration(self) -> Calibration: ...


def summary_of(answer: Answer) -> str:
    """One line that a technician understands."""
    if answer.findings:
        common = [s for s in answer.structures if not s.sensors]
        return joined(" ", (_named(answer.findings), *([told(common)] if common else [])))
    if answer.structures:
        return joined(" ", (told(answer.structures), *errors_of(answer)))
    return nothing_of(answer)


def nothing_of(answer: Answer) -> str:
    """That nothing is wrong, unless it is what the file says of the noise, or nothing is left to judge by."""
    if answer.calibration.fit.is_exact:
        return say("{nothing_left}. {taken_up}", nothing_left=NOTHING_LEFT, taken_up=TAKEN_UP)
    if answer.noise:
        return say("{nothing}{but}.", nothing=NOTHING, but=but_wrong_errors(answer.noise, _kinds(answer)))
    return say("{nothing}: the simulation explains the readings.", nothing=NOTHING)


def errors_of(answer: Answer) -> tuple[str, ...]:
    """Which stated standard errors are wrong, a sentence each."""
    return wrong_errors(answer.noise, _kinds(answer))


def _kinds(answer: Answer) -> set[str]:
    return {sensor.kind for sensor in answer.calibration.sensors}


def _named(findings: Sequence[Finding]) -> str:
    """The first findings; two that are one choice are told once."""
    said = tuple(dict.fromkeys(what_is_wrong(finding, findings) for finding in findings))
    more = len(said) - MOST_FINDINGS
    return joined(" ", said[:MOST_FINDINGS]) + (say(" And {more} more.", more=more) if more > 0 else "")


CANNOT = "The session cannot be diagnosed: {fault}"


def cannot_be_diagnosed(fault: SessionError) -> str:
    """What the session lacks."""
    return say(CANNOT, fault=fault)


def fault_of_the_program(session: str) -> str:
    """That the program failed, and what holds all the same."""
    return say(
        "The program failed at this diagnosis, met something that it does not foresee, or needed "
        "too much time or memory: that is a fault of the program, not of the session. The "
        "session, its calibration and its verdict are stored and hold, and the next version of "
        "the program diagnoses it again. The log says what happened, under session {session}: "
        "send that to those who maintain the program.",
        session=session,
    )


def headline(answer: Answer) -> str:
    """The first cause or the choice that cannot be made; without one what the diagnosis came to."""
    if answer.findings:
        return what_is_wrong(answer.findings[0], answer.findings)
    if answer.structures:
        return headline_of(answer.structures)
    if answer.calibration.fit.is_exact:
        return NOTHING_LEFT
    return say("{nothing}{but}", nothing=NOTHING, but=but_wrong_errors(answer.noise, _kinds(answer)))


def what_to_do(answer: Answer) -> str:
    """What a technician does next."""
    if answer.findings:
        return _about(answer.findings[0], answer.findings)
    if answer.structures:
        return what_to_do_about(answer.structures)
    if answer.calibration.fit.is_exact:
        return too_few(answer.calibration) or TAKEN_UP
    return RESTATE if answer.noise else AGREE


def _about(finding: Finding, findings: Sequence[Finding]) -> str:
    if not finding.alternatives:
        return finding.advice
    if at_once_with(finding, findings):
        return REPEAT_BOTH
    if is_lone(finding):
        return REPEAT
    return CHOOSE if is_level(finding) else RULE_OUT
