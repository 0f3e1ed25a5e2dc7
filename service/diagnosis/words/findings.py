"""Alternatives to a finding, measurements that distinguish them, and the ranking of all causes."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import floor, isfinite, log10

from estimator.causes import find
from estimator.causes.sensor import ExcessNoise
from estimator.diagnosis import Finding
from estimator.diagnosis.explanation.naming import sentence
from estimator.diagnosis.results import Course, OverSessions, ParitySplit, Separation, Structure
from estimator.message import changed, joined, say, uncapitalised
from estimator.moments import moment
from service.diagnosis.words.amplitudes import amplitudes_of, more_of, shape_of
from service.diagnosis.words.causes import (
    SHOWN_SHARE,
    UNKNOWN_CAUSE,
    cause_name,
    cause_on,
    is_level,
    is_lone,
    percent,
    share_of,
    what_is_wrong,
)
from service.kit.measures import HARD, day_of, number
from service.models.records import ModelRevision

DISTINGUISHED = 3.0
"""Expected separation, standard errors, below which a measurement would not help: the estimator's own bound."""
ALWAYS_SHOWN = 3
"""Lines of the ranking that are shown however small their share."""
IF_IT_COMES_BACK = "repeat the session: a correctly named cause appears again"


@dataclass(frozen=True)
class CauseChoice:
    """One of several causes that this session cannot distinguish."""

    cause: str
    name: str
    share: str
    """Probability among all known causes."""
    now: str
    """Separation from the first one in this session."""
    measurement: str
    """Measurement that would distinguish it from the first one."""
    meaning: str = ""
    """The fault if it is this cause, in a sentence; empty for one that is not in the catalogue."""


@dataclass(frozen=True)
class Bar:
    """One line of the ranking of causes."""

    name: str
    percent: str
    width: float
    """0 to 100."""


def choices_of(finding: Finding) -> Iterator[CauseChoice]:
    """The named cause and its alternatives."""
    apart = {separation.cause: separation for separation in finding.separations}
    for name in (finding.cause, *finding.alternatives) if finding.alternatives else ():
        if name == UNKNOWN_CAUSE:
            yield CauseChoice(name, cause_on(name, finding.sensors), "–", "", IF_IT_COMES_BACK)
            continue
        share = share_of(name, finding)
        yield CauseChoice(
            name, cause_on(name, finding.sensors), share, *_apart(apart.get(name)), _meaning(name, finding)
        )


def _meaning(name: str, finding: Finding) -> str:
    known = find(name)
    sensors = next((rival.sensors for rival in finding.ranking if rival.cause == name), finding.sensors)
    return "" if known is None or ("{sensors}" in known.sentence and not sensors) else sentence(known, sensors)


def _apart(separation: Separation | None) -> tuple[str, str]:
    """Separation of a rival now, and the measurement that would distinguish it, with the expected separation."""
    if separation is None:
        return "", ""
    expected = separation.then or 0.0
    if not separation.measurement or expected < DISTINGUISHED:
        return _sigmas(separation.now), "this stand or programme cannot separate them; inspect the hardware"
    return _sigmas(separation.now), say(
        "{measurement} (expected separation {expected})", measurement=separation.measurement, expected=_sigmas(expected)
    )


def _sigmas(value: float) -> str:
    return f"{number(value, 1)}{HARD}σ"


def ranking_of(finding: Finding) -> Iterator[Bar]:
    """Rival causes with their shares; those that are out of the question are left out."""
    for place, rival in enumerate(finding.ranking):
        if place < ALWAYS_SHOWN or rival.probability > SHOWN_SHARE:
            name = cause_on(rival.cause, rival.sensors)
            yield Bar(name, percent(rival.probability), 100 * rival.probability)


SURE = 1e-12
"""Probability by chance below which the exponent says no more."""
SUPERSCRIPT = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
"""Superscript digits of a power of ten."""


@dataclass(frozen=True)
class FindingView:
    """A named cause with its evidence, for people."""

    cause: str
    name: str
    """Name of the cause."""
    statement: str
    """The fault, or the choice that cannot be made."""
    sentence: str
    """The fault if it is the first of several causes."""
    doubtful: bool
    level: bool
    """Whether its several causes are about equally likely."""
    lone: bool
    """Whether it is the only known cause that fits, beside one that is not in the catalogue."""
    advice: str
    amplitudes: tuple[str, ...]
    shape: str
    more: tuple[str, ...]
    """Sensors that follow a shared course faintly, each with its size."""
    evidence: str
    choices: tuple[CauseChoice, ...]
    ranking: tuple[Bar, ...]
    parity: str
    since: str
    acceptable: tuple[tuple[str, str], ...]
    """Causes that can become part of a model: identifier and name."""
    held: bool
    """Whether the model holds it in every session, accepted or not."""
    together: bool
    """Whether only several sessions of the unit show it."""
    sensors: tuple[str, ...]
    accepted: tuple[int, ...]
    """Revisions that already hold it for this session."""


def finding_view(
    finding: Finding,
    revisions: Sequence[ModelRevision] = (),
    findings: Sequence[Finding] = (),
    *,
    by_stated_noise: bool = False,
) -> FindingView:
    """A finding for people; ``findings``: all of its diagnosis."""
    names = (finding.cause, *finding.alternatives)
    first = find(finding.cause)
    of_noise, held = isinstance(first, ExcessNoise), first is not None and first.always_modelled
    together = finding.over_sessions
    known = [] if held or together else [c for name in names if (c := find(name)) and c.can_be_modelled]
    return FindingView(
        cause=finding.cause,
        name=cause_name(finding.cause),
        statement=what_is_wrong(finding, findings),
        sentence=finding.sentence,
        doubtful=bool(finding.alternatives),
        level=is_level(finding),
        lone=is_lone(finding),
        advice=finding.advice,
        amplitudes=tuple(amplitudes_of(finding)),
        shape=shape_of(finding),
        more=more_of(finding),
        evidence=evidence(finding.strength, finding.p_value, by_stated_noise=by_stated_noise and not of_noise)
        if together is None
        else evidence_together(finding.strength, together),
        choices=tuple(choices_of(finding)),
        ranking=tuple(ranking_of(finding)),
        parity=_parity(finding.parity),
        since=_since(finding.new) if together is None else since_together(together),
        acceptable=tuple((c.identifier, c.name) for c in known),
        held=held,
        together=together is not None,
        sensors=finding.sensors,
        accepted=tuple(r.id for r in revisions if r.cause in names),
    )


def evidence(strength: float, p_value: float, *, by_stated_noise: bool = False) -> str:
    """The strength of an effect, and how often a session with nothing wrong would show as much.

    ``by_stated_noise``: the noise is as stated in the file, untested.
    """
    condition = ", if the noise is as stated" if by_stated_noise and isfinite(p_value) else ""
    parts = {"strength": standard_errors(strength), "p_value": _chance(p_value), "condition": condition}
    return say("{strength}; {p_value}{condition}", **parts)


def evidence_together(strength: float, over: OverSessions) -> str:
    """The strength of an effect that no session shows alone, and the probability that this one has it."""
    parts = {"strength": standard_errors(strength), "sessions": over.sessions, "probability": percent(over.here)}
    return say(
        "{strength} over {sessions} sessions of the unit; probability that this one has it too: {probability}", **parts
    )


def since_together(over: OverSessions) -> str:
    """Whether earlier sessions had it."""
    if over.since is not None:
        return say("It began on {date}.", date=day_of(moment(over.since)))
    if over.form == "since":
        return "It began in one of the earlier sessions."
    if over.form == "varying":
        return "Present in the earlier sessions too, with a different size each time."
    return _since(False)


def standard_errors(strength: float) -> str:
    """``12.3 standard errors``."""
    return say("{strength} standard errors", strength=number(strength, 1))


def _chance(p_value: float) -> str:
    if not isfinite(p_value):
        return "no probability is known"
    if p_value < SURE:
        return "by chance in fewer than 1 of 10¹² sound sessions"
    if p_value < 1e-3:
        exponent = str(floor(-log10(p_value))).translate(SUPERSCRIPT)
        return say("by chance in fewer than 1 of 10{exponent} sound sessions", exponent=exponent)
    return say("by chance in {p_value}{hard}% of sound sessions", p_value=number(100 * p_value, 2), hard=HARD)


def _parity(split: ParitySplit | None) -> str:
    """Stand or sensor: what redundancy says."""
    if split is None or not (isfinite(split.parity_before) and isfinite(split.parity_after)):
        return ""
    before, after = number(split.parity_before, 0), number(split.parity_after, 0)
    if before == after:
        return ""
    seen, left = number(split.range_before, 0), number(split.range_after, 0)
    parts = {"before": before, "after": after, "axes": seen, "remaining_axes": left}
    return say(
        "χ² in parity space {before} → {after}, along the axes {axes} → {remaining_axes}. A fault of one sensor shows "
        "in parity space; an error of the stand does not.",
        **parts,
    )


def _since(new: bool | None) -> str:
    if new is None:
        return ""
    return "New since the earlier sessions." if new else "Present in the earlier sessions too."


UNEXPLAINED = "An effect that no known cause explains"
COMMON = "An effect common to all sensors, of the stand or fixture, that no known cause explains"
MIXED_UP = "The record is wrong"
SIZE = "size"
"""The component of a course that no turn of the applied vector makes."""
COMPONENTS = {
    "β": "the angle β of the head were wrong",
    "α": "the angle α of the stand were wrong",
    SIZE: "gravity or the rate were larger",
    "β of the gyros": "the angle β were wrong, for the gyros only",
    "α of the gyros": "the angle α were wrong, for the gyros only",
}
"""Pattern of each component of a course, as the change of the applied vector that would cause it."""
IN_COMMON = "the applied vector, common to all sensors: "
"""Beginning of the place of a pattern common to all sensors; removed in a sentence that says so already."""
LOOK_AT_SENSOR = "Look at where it occurs, repeat the session, and compare with another unit or stand."
LOOK_AT_STAND = (
    "All sensors show it, so no sensor causes it. Check the stand, the fixture and the reference: play, levelling, "
    "clamping, angle readout. Then measure another unit there: it should show the same."
)
LOOK_AT_RECORD = "Check columns, runs, angles and signs in the file. Correct it and upload it again."


def headline_of(structures: Sequence[Structure]) -> str:
    """The headline of patterns, in a few words: of the record first, because nothing else holds where that is wrong."""
    first = leading(structures)
    return MIXED_UP if first.of_record else UNEXPLAINED if first.sensors else COMMON


def what_to_do_about(structures: Sequence[Structure]) -> str:
    """The next action of the technician."""
    first = leading(structures)
    return LOOK_AT_RECORD if first.of_record else LOOK_AT_SENSOR if first.sensors else LOOK_AT_STAND


def leading(structures: Sequence[Structure]) -> Structure:
    """The pattern that is named first."""
    return next((s for s in structures if s.of_record), structures[0])


def in_words(structures: Sequence[Structure]) -> str:
    """The kind of pattern, its sensors and its place, in one line."""
    first = leading(structures)
    named = first.sensors and not first.of_record
    headline = unexplained_in(first.sensors) if named else headline_of(structures)
    return say("{structures}: {first}.", structures=headline, first=where_of(first))


def unexplained_in(sensors: Sequence[str]) -> str:
    """``An effect in A2, A3 that no known cause explains``."""
    return say("An effect in {sensors} that no known cause explains", sensors=joined(", ", sensors))


def summed_up(structures: Sequence[Structure]) -> str:
    """The kind of pattern and its sensors, in one line."""
    if leading(structures).of_record:
        return in_words(structures)
    sensors = sorted({sensor for structure in structures for sensor in structure.sensors})
    unexplained = unexplained_in(sensors)
    if all(structure.sensors for structure in structures):
        return say("{unexplained}.", unexplained=unexplained)
    beside = say(" In addition: {unexplained}.", unexplained=uncapitalised(unexplained)) if sensors else ""
    return say("{common}.{beside}", common=COMMON, beside=beside)


def who_of(structure: Structure) -> str:
    """``A1, A2``, or all."""
    return joined(", ", structure.sensors) or "all sensors together"


def where_of(structure: Structure) -> str:
    """The place of a pattern; for a course, its effect on the applied vector."""
    if structure.course is not None:
        return say("the applied vector {course}", course=course_in_words(structure.course))
    return changed(structure.where, lambda text: text.removeprefix(IN_COMMON))


def component_in_words(component: str) -> str:
    """``as if the angle β of the head were off``; of another version's component its name."""
    return say("as if {components}", components=COMPONENTS[component]) if component in COMPONENTS else component


def course_in_words(course: Course) -> str:
    """``runs off in α along β, each run for itself``."""
    if not course.components:
        return course.order
    quantity = joined(" and ", course.components)
    if course.order.startswith("no order"):
        return say("deviates in {what}, independently in every row", what=quantity)
    if course.order.startswith("harmonic"):
        return say("deviates in {what}, {order}", what=quantity, order=course.order)
    return say("deviates in {what}, smoothly along {order}", what=quantity, order=course.order)
