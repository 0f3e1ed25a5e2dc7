"""A diagnosis in words: its result in one line, at the head of a page, and the action to take."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Protocol

from estimator.causes import find
from estimator.diagnosis import Finding
from estimator.diagnosis.results import Limit, NoiseScale, Structure
from estimator.errors import SessionError
from estimator.message import joined, say
from estimator.results import Calibration
from estimator.session import GYROSCOPE
from service.diagnosis.words.amplitudes import amplitude_measure
from service.diagnosis.words.causes import (
    ONE_NOT_KNOWN,
    at_once_with,
    cause_name,
    is_level,
    is_lone,
    weighty_first,
    what_is_wrong,
)
from service.diagnosis.words.findings import UNEXPLAINED, headline_of, in_words, what_to_do_about
from service.kit.measures import THIN, leading_kind, number
from service.sessions.records import DiagnosisState
from service.sessions.words.advice import too_few
from service.sessions.words.noise import but_wrong_errors, is_tenfold, wrong_errors

NOT_APPLICABLE = (
    "Not applicable to this programme: causes are looked for in calibrations, on a stand or in still orientations, and "
    "in alignments on a turntable."
)
NOTHING = "Nothing wrong found"
FAR_BEYOND = "The readings scatter far beyond their noise, and no known cause explains it"
NOTHING_LEFT = "Too few positions for a diagnosis"
TAKEN_UP = "There are as many parameters as readings, so no cause can be found: add positions."
MOST_FINDINGS = 3
"""Findings that one line names before it counts the rest."""
HEADLINES = {
    DiagnosisState.NOTHING: NOTHING,
    DiagnosisState.UNEXPLAINED: UNEXPLAINED,
    DiagnosisState.FAILED: "This session could not be diagnosed",
    DiagnosisState.NOT_APPLICABLE: "Not applicable to this programme",
}
"""Headlines where the answer itself is not at hand."""
STILL_MADE = "The diagnosis needed for this is still running: ask again in a few seconds."
AGREE = "Measurement and simulation agree within the noise: no known cause and no other structure was found."
RESTATE = (
    "No known cause and no other structure was found. But the scatter of the readings is not the stated one: correct "
    "the standard errors in the file."
)
CHOOSE = "This session cannot separate these causes. Before you act on one of them, make the measurement that can."
RULE_OUT = "This session does not rule out the less likely causes. Before you act, make the measurement that does."
REPEAT = say(
    "One known cause explains it, but so could {one_not_known}. Repeat the session before you act: if the named "
    "cause is right, it appears again.",
    one_not_known=ONE_NOT_KNOWN,
)
REPEAT_BOTH = say(
    "Two causes at once on one sensor are rare, and {one_not_known} could also explain it. Repeat the session before "
    "you act: if the named causes are right, both appear again.",
    one_not_known=ONE_NOT_KNOWN,
)


class DiagnosisAnswer(Protocol):
    """Result of a diagnosis, as it was made or as it is stored."""

    @property
    def findings(self) -> tuple[Finding, ...]: ...
    @property
    def structures(self) -> tuple[Structure, ...]: ...
    @property
    def noise(self) -> tuple[NoiseScale, ...]: ...
    @property
    def calibration(self) -> Calibration: ...


def summary_of(answer: DiagnosisAnswer) -> str:
    """One line that a technician understands."""
    if answer.findings:
        common = [s for s in answer.structures if not s.sensors]
        return joined(" ", (_named(weighty_first(answer.findings)), *([in_words(common)] if common else [])))
    if answer.structures:
        return joined(" ", (in_words(answer.structures), *errors_of(answer)))
    return nothing_of(answer)


def nothing_of(answer: DiagnosisAnswer) -> str:
    """The sentence that nothing is wrong, with a reservation where the stated noise is, or where no reading is left to
    judge by.
    """
    if answer.calibration.fit.is_exact:
        return say("{summary}. {fits}", summary=NOTHING_LEFT, fits=TAKEN_UP)
    if answer.noise:
        return say(
            "{summary}{reservation}.",
            summary=_nothing(answer),
            reservation=but_wrong_errors(answer.noise, _kinds(answer)),
        )
    return say("{summary}: the simulation explains the readings.", summary=NOTHING)


def errors_of(answer: DiagnosisAnswer) -> tuple[str, ...]:
    """The stated standard errors that are wrong, a sentence each."""
    return wrong_errors(answer.noise, _kinds(answer))


def _kinds(answer: DiagnosisAnswer) -> set[str]:
    return {sensor.kind for sensor in answer.calibration.sensors}


def _named(findings: Sequence[Finding]) -> str:
    """The first findings in words; two that are one choice are named once."""
    said = tuple(dict.fromkeys(what_is_wrong(finding, findings) for finding in findings))
    more = len(said) - MOST_FINDINGS
    return joined(" ", said[:MOST_FINDINGS]) + (say(" And {number} more.", number=more) if more > 0 else "")


CANNOT = "The session cannot be diagnosed: {fault}"


def cannot_be_diagnosed(fault: SessionError) -> str:
    """The reason in the session why it cannot be diagnosed."""
    return say(CANNOT, fault=fault)


def fault_of_the_program(session: str) -> str:
    """The sentence that the program failed, and that session, calibration and verdict hold all the same."""
    return say(
        "The program failed at this diagnosis or needed too much time or memory: that is a fault of the program, not "
        "of the session. Session, calibration and verdict are stored and valid, and the next version of the program "
        "diagnoses the session again. Send the log's lines about session {session} to the maintainers of the program.",
        session=session,
    )


def headline(answer: DiagnosisAnswer) -> str:
    """The first cause or the choice that cannot be made; without one the result of the diagnosis."""
    if answer.findings:
        return what_is_wrong(weighty_first(answer.findings)[0], answer.findings)
    if answer.structures:
        return headline_of(answer.structures)
    if answer.calibration.fit.is_exact:
        return NOTHING_LEFT
    reservation = but_wrong_errors(answer.noise, _kinds(answer))
    return say("{summary}{reservation}", summary=_nothing(answer), reservation=reservation)


def _nothing(answer: DiagnosisAnswer) -> str:
    return FAR_BEYOND if is_tenfold(answer.noise) else NOTHING


def what_to_do(answer: DiagnosisAnswer) -> str:
    """The next action of the technician."""
    if answer.findings:
        return _about(weighty_first(answer.findings)[0], answer.findings)
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


FULLER = {"the session lacks vibration": "no vibration was recorded, or it was the same in every row"}
"""Reasons that people would take for something else as the estimator puts them."""


@dataclass(frozen=True)
class SeenCause:
    """The smallest effect of one cause that would have been found."""

    cause: str
    size: str


@dataclass(frozen=True)
class BlindCauses:
    """Causes that the session cannot see, and why."""

    causes: str
    reason: str


def seen_causes(limits: Sequence[Limit], kinds: Collection[str]) -> tuple[SeenCause, ...]:
    """Causes that a session would find, with the size from which on, at sensors of these kinds."""
    kind = leading_kind(kinds)
    return tuple(SeenCause(cause_name(limit.cause), size_of(limit, kind)) for limit in limits if limit.amplitude)


def blind_causes(limits: Sequence[Limit]) -> tuple[BlindCauses, ...]:
    """Causes that a session cannot see, by reason."""
    names: dict[str, list[str]] = {}
    for limit in limits:
        if limit.amplitude is None:
            names.setdefault(FULLER.get(limit.reason, limit.reason), []).append(cause_name(limit.cause))
    return tuple(BlindCauses(joined(", ", causes), reason) for reason, causes in names.items())


def size_of(limit: Limit, kind: str) -> str:
    """Every amplitude once: two that agree to a tenth are one number."""
    stated = zip(limit.amplitude or (), limit.units, strict=False)
    shown = (_amplitude(limit.cause, value, _unit(limit.cause, si_unit, kind)) for value, si_unit in stated)
    return joined("; ", dict.fromkeys(filter(None, shown))) or "–"


def _unit(cause: str, si_unit: str, kind: str) -> str:
    """A limit states its unit as for an accelerometer; where a gyro is meant, m/s² is rad/s."""
    known = find(cause)
    is_of_both = known is not None and known.kind is None
    return si_unit.replace("m/s²", "rad/s") if kind == GYROSCOPE and is_of_both else si_unit


def _amplitude(cause: str, value: float, si_unit: str) -> str:
    if not isfinite(value):
        return ""
    measure = amplitude_measure(cause, si_unit, value)
    return f"{number(float(f'{value * measure.factor:.2g}'))}{THIN}" + measure.label
