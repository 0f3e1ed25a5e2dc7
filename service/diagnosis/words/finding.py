"""A finding of a diagnosis in words: the cause, its evidence, what else it could be, and since when."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, isfinite, log10

from estimator.causes import find
from estimator.causes.noise import ExcessNoise
from estimator.diagnosis import Finding
from estimator.diagnosis.results import OverSessions, ParitySplit
from estimator.message import say
from estimator.moments import moment
from service.diagnosis.words.amplitudes import amplitudes_of, more_of, shape_of
from service.diagnosis.words.causes import cause_name, is_level, is_lone, percent, what_is_wrong
from service.diagnosis.words.rivals import Bar, Choice, choices_of, ranking_of
from service.kit.measures import HARD, number
from service.kit.names import day_of
from service.models.records import ModelRevision

SURE = 1e-12
"""Probability by chance below which the exponent tells nobody more."""
SUPERSCRIPT = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
"""Of a power of ten."""


@dataclass(frozen=True)
class FindingView:
    """A named cause with its evidence, for people."""

    cause: str
    name: str
    """What the cause is called."""
    statement: str
    """What is wrong, or the choice that cannot be made."""
    sentence: str
    """What is wrong if it is the first of several causes."""
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
    choices: tuple[Choice, ...]
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
    """What a technician and an engineer read of a finding; ``findings``: all of its diagnosis."""
    names = (finding.cause, *finding.alternatives)
    first = find(finding.cause)
    of_noise, held = isinstance(first, ExcessNoise), first is not None and first.always_modelled
    together = finding.over_sessions
    known = [] if held or together else [one for name in names if (one := find(name)) and one.can_be_modelled]
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
        acceptable=tuple((one.identifier, one.name) for one in known),
        held=held,
        together=together is not None,
        sensors=finding.sensors,
        accepted=tuple(r.id for r in revisions if r.cause in names),
    )


def evidence(strength: float, p_value: float, *, by_stated_noise: bool = False) -> str:
    """How strong an effect is, and how often a session with nothing wrong would show as much.

    ``by_stated_noise``: the file says what noise is, and nothing has put that to the test.
    """
    condition = ", if the noise is as stated" if by_stated_noise and isfinite(p_value) else ""
    return say(
        "{strength}; {p_value}{condition}",
        strength=standard_errors(strength),
        p_value=_chance(p_value),
        condition=condition,
    )


def evidence_together(strength: float, over: OverSessions) -> str:
    """How strong an effect is that no session shows alone, and how likely this one has it."""
    return say(
        "{strength} over {sessions} sessions of the unit together; that this one has it too: {here}",
        strength=standard_errors(strength),
        sessions=over.sessions,
        here=percent(over.here),
    )


def since_together(over: OverSessions) -> str:
    """Whether earlier sessions had it."""
    if over.since is not None:
        return say("It began on {since}.", since=day_of(moment(over.since)))
    if over.form == "since":
        return "It began in one of the earlier sessions."
    if over.form == "varying":
        return "It was there in the earlier sessions too, but different every time."
    return _since(False)


def standard_errors(strength: float) -> str:
    """``12.3 standard errors``."""
    return say("{strength} standard errors", strength=number(strength, 1))


def _chance(p_value: float) -> str:
    if not isfinite(p_value):
        return "no probability is known"
    if p_value < SURE:
        return "by chance alone in fewer than 1 of 10¹² sound sessions"
    if p_value < 1e-3:
        exponent = str(floor(-log10(p_value))).translate(SUPERSCRIPT)
        return say("by chance alone in fewer than 1 of 10{exponent} sound sessions", exponent=exponent)
    return say("by chance alone in {p_value}{hard}% of sound sessions", p_value=number(100 * p_value, 2), hard=HARD)


def _parity(split: ParitySplit | None) -> str:
    """Stand or sensor: what redundancy says."""
    if split is None or not (isfinite(split.parity_before) and isfinite(split.parity_after)):
        return ""
    before, after = number(split.parity_before, 0), number(split.parity_after, 0)
    if before == after:
        return ""
    seen, left = number(split.range_before, 0), number(split.range_after, 0)
    return say(
        "χ² in parity space {before} → {after}, along the axes {seen} → {left}. An error of the "
        "stand leaves nothing in parity space; a fault of one sensor does.",
        before=before,
        after=after,
        seen=seen,
        left=left,
    )


def _since(new: bool | None) -> str:
    if new is None:
        return ""
    return "New since the earlier sessions." if new else "It was there in the earlier sessions too."
