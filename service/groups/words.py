"""Joint diagnosis of many sessions, in words."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256

from estimator.groups import GroupFinding
from estimator.groups.fixed import EMPIRICAL
from estimator.groups.layout import EVERY
from estimator.groups.results import EmpiricalTerm, GroupGain, GroupRival, PoolLimit, SessionAmplitude
from estimator.message import Message, capitalised, joined, say, say_count, uncapitalised, without_stop
from estimator.moments import moment
from estimator.session import ACCELEROMETER
from service.diagnosis.words.amplitudes import amplitude_measure, amplitudes_of
from service.diagnosis.words.causes import cause_name, cause_on, percent
from service.diagnosis.words.diagnosis import size_of
from service.diagnosis.words.findings import standard_errors
from service.diagnosis.words.gain import errors_in_words
from service.groups.records import Group, GroupShown
from service.kit.measures import COVERAGE, HARD, day_of, measured, number
from service.models.records import SCOPES, ModelRevision, Scope

FAILED = (
    "The program could not evaluate these sessions together: that is a fault of the program, not of the sessions. The "
    "next version tries again."
)
LONGEST_PLACE = 200
"""Characters that a flag keeps of its place."""
LONGEST_SUBJECT = 100
"""Sentences about a name in it."""
SHARED = "They share structure that no known cause explains."
SOUND = "Nothing wrong found."
UNKNOWN = "Structure that no known cause explains."
NO_SESSION = "No accepted session calibrates a block."


def over(sessions: int) -> str:
    """``Over 34 sessions``."""
    return "Over one session" if sessions == 1 else say("Over {sessions} sessions", sessions=sessions)


def summary_of_group(sessions: int, findings: Sequence[GroupFinding], *, unexplained: bool = False) -> str:
    """The joint diagnosis of a group's sessions in one line."""
    if not sessions:
        return NO_SESSION
    if findings:
        return say("{sessions}: {statement}", sessions=over(sessions), statement=joined(" ", map(statement, findings)))
    if unexplained:
        return say("{sessions}: {summary}", sessions=over(sessions), summary=uncapitalised(SHARED))
    return say("{sessions}: {summary}", sessions=over(sessions), summary=uncapitalised(SOUND))


def own_of_group(group: Group, findings: Sequence[GroupFinding], *, unexplained: bool) -> str:
    """The findings that belong to the group itself, in words; empty for none.
    ``unexplained``: whether its sessions share a structure of the group that no cause explains.
    """
    mine = (group.level.value, group.name)
    said = [statement(f) for f in findings if (f.level, f.subject) == mine]
    if unexplained:
        said.append(UNKNOWN)
    return joined(" ", said)


def statement(finding: GroupFinding) -> str:
    """The finding and its alternatives: ``A2 has a cubic nonlinearity; it could also be odd quadratic.``"""
    if not finding.alternatives:
        return finding.sentence
    others = joined(" or ", dict.fromkeys(map(cause_name, finding.alternatives)))
    return say("{sentence}; it could also be {others}.", sentence=without_stop(finding.sentence), others=others)


def place_in_words(place: str, subject: str) -> str:
    """The place of a lasting flag as people read it: it is a key, made of scope, subject, cause and sensors."""
    scope, known, rest = place.partition(f" {subject}: ")
    cause, bracket, sensors = rest.partition(" (")
    if not known:
        return place
    where = say(" ({sensors})", sensors=sensors.removesuffix(")")) if bracket else ""
    return say("{scope} {subject}: {cause}{sensors}", scope=scope, subject=subject, cause=cause, sensors=where)


def lasting_place(scope: Scope, subject: str, finding: GroupFinding | None = None) -> str:
    """``stand ODG-1: beta eccentricity``: where a flag on it is; without a finding how those of a group begin.

    Of a long name the end becomes a hash, so that the effect has room.
    """
    is_long = len(subject) > LONGEST_SUBJECT
    name = f"{subject[:LONGEST_SUBJECT]}… {sha256(subject.encode()).hexdigest()[:8]}" if is_long else subject
    owner = f"{scope} {name}: "
    return owner if finding is None else f"{owner}{cause_on(finding.cause, finding.sensors)}"[:LONGEST_PLACE]


def lasting_summary(scope: Scope, finding: GroupFinding) -> str:
    """``The sessions on stand ODG-1 show together: The angle scale of the head is off centre.``"""
    if scope is Scope.STAND:
        parts = {"subject": finding.subject, "finding": statement(finding)}
        return say("The sessions on stand {subject} show together: {finding}", **parts)
    if scope is Scope.UNIT_TYPE:
        return say(
            "The sessions of unit type {subject} show together: {finding}",
            subject=finding.subject,
            finding=statement(finding),
        )
    return say(
        "The sessions of unit {subject} show together: {finding}", subject=finding.subject, finding=statement(finding)
    )


READS = "{sensor} reads high by"
TURNS = {"δα": "the elevation α is larger by", "δβ": "the angle β is larger by"}
"""Beginning of a term's line, by the angle that it turns."""


@dataclass(frozen=True)
class TermView:
    """A learned term, for people."""

    lines: tuple[tuple[str, str], ...]
    """Affected quantity with ``is larger by`` or the like, and the amount."""
    whose: str
    """Unit, unit type or stand from whose sessions the term was learned."""
    worth: str
    nearest: str
    sensors: tuple[str, ...] = ()
    model: str = ""
    """Model that it can become part of: ``unit BA-017``; empty where the sessions name none."""
    accepted: tuple[int, ...] = ()
    """Revisions in force that hold it."""


def term_view(term: EmpiricalTerm, accepted: Sequence[ModelRevision] = ()) -> TermView:
    """A learned term for people; ``accepted``: the revisions that are in force."""
    scope = SCOPES.get(term.level) if term.subject else None
    near = say("{separation} standard errors from it", separation=number(term.separation, 1))
    return TermView(
        lines=tuple(_lines(term)),
        whose=term.subject,
        worth=say(
            "It removes {explained}{nbsp}% of the excess in the sessions not used to learn it.",
            explained=number(100 * term.explained, 0),
            nbsp=HARD,
        ),
        nearest=say(
            "Nearest in the catalogue: {nearest}, {similarity}.", nearest=cause_name(term.nearest), similarity=near
        )
        if term.nearest
        else "",
        sensors=term.sensors,
        model="" if scope is None else say("{scope} {subject}", scope=scope, subject=term.subject),
        accepted=tuple(r.id for r in accepted if holds_term(r, term)),
    )


def holds_term(revision: ModelRevision, term: EmpiricalTerm) -> bool:
    """Whether a revision accepted a learned term of this place: an equation that was learned anew is another one of
    it, and not beside it."""
    key = (revision.cause, revision.scope, revision.subject, revision.sensors)
    return key == (EMPIRICAL, SCOPES.get(term.level), term.subject, term.sensors)


def equation_of(term: EmpiricalTerm) -> str:
    """``A3 reads more by (3.1 ± 0.2) µg · sin 3β.``"""
    return joined(
        " ",
        (
            say("{quantity} {equation}.", quantity=capitalised(quantity), equation=equation)
            for quantity, equation in _lines(term)
        ),
    )


def _lines(term: EmpiricalTerm) -> Iterator[tuple[str, str]]:
    """One for the sensor, or for each angle of the applied vector that is turned."""
    found: dict[str, list[str]] = {}
    for word, value, sigma, unit in zip(term.words, term.amplitude, term.sigma, term.units, strict=True):
        target, _, factor = word.rpartition(": ")
        spread = COVERAGE * sigma
        measure = amplitude_measure("", unit, max(abs(value), spread))
        found.setdefault(target, []).append(
            say("({size}){nbsp}·{nbsp}{factor}", size=measured(value, spread, measure), nbsp=HARD, factor=factor)
        )
    for target, parts in found.items():
        yield TURNS.get(target, say(READS, sensor=joined(", ", term.sensors))), joined(" + ", parts)


def latest_in_words(shown: GroupShown) -> str:
    """The reduction of the latest session's errors by the findings, at the sizes that earlier sessions fixed; empty
    where that is not known.
    """
    gain = shown.gain
    if gain is None or gain.before is None or gain.after is None:
        return ""
    names = {sensor for f in shown.findings for sensor in f.sensors or (EVERY,)}
    parts = errors_in_words(gain.before, gain.after, () if EVERY in names else tuple(names))
    return (
        say(
            "In the latest session the error {parts} (sizes as the first {fitted} sessions fixed them).",
            parts=parts,
            fitted=gain.fitted,
        )
        if parts
        else ""
    )


def gain_in_words(gain: GroupGain | None) -> str:
    """The gain from the findings in later sessions; empty where there were too few."""
    if gain is None:
        return ""
    before, after = (number(x, 3) for x in (gain.chi2_per_dof_before, gain.chi2_per_dof_after))
    likelier = (
        say("{log_score} more", log_score=number(gain.log_score, 1))
        if gain.log_score > 0
        else say("{log_score} less", log_score=number(-gain.log_score, 1))
    )
    parts = {"fitted": gain.fitted, "held_out": gain.held_out, "before": before, "after": after, "likelier": likelier}
    return say(
        "Sizes estimated from the first {fitted} sessions, tested on the {held_out} later ones: χ² per degree of "
        "freedom {before} → {after}, log score {likelier}.",
        **parts,
    )


FORMS = {"same": "in all of these sessions", "varying": "on average in these sessions, with a different size each time"}
MOMENT = re.compile(r"\d{4}-\d\d-\d\dT[\d:.]+(?:Z|[+-]\d\d:\d\d)?")
"""A moment as files state it, ISO 8601."""
BLIND = "–"
"""Text in place of a size that no number of such sessions shows, and of a date that is not known."""


RULE_OUT = "These sessions do not rule out the other causes. Before you act on one, make the measurement that does."


@dataclass(frozen=True)
class GroupChoice:
    """A rival cause, and the measurement that would decide."""

    name: str
    share: str
    measurement: str


@dataclass(frozen=True)
class ForestRow:
    """The effect in one session alone."""

    day: str
    unit: str
    amplitude: str


@dataclass(frozen=True)
class LastingEffect:
    """A finding of a group, for people."""

    cause: str
    sensors: tuple[str, ...]
    whose: str
    """``unit BA-017``."""
    accepted: tuple[int, ...]
    """Revisions in force that hold it."""
    statement: str
    amplitudes: tuple[str, ...]
    since: str
    spread: str
    """Scatter from session to session, one standard deviation; empty for an effect that is always the same."""
    evidence: str
    advice: str
    choices: tuple[GroupChoice, ...]
    rows: tuple[ForestRow, ...]
    """Effect in single sessions, newest first."""


@dataclass(frozen=True)
class GroupView:
    """Joint diagnosis of a group's sessions, for people."""

    heading: str
    summary: str
    left_out: int
    effects: tuple[LastingEffect, ...]
    structures: tuple[str, ...]
    """Places of structure in the residuals that no cause explains."""
    terms: tuple[TermView, ...]
    error: str
    """Reduction of the latest session's errors by the findings, one number a sensor."""
    gain: str
    notes: tuple[str, ...]
    limits: tuple[tuple[str, str, str], ...]
    """Cause, the smallest size that the pool would find, and that one session would."""


def group_view(shown: GroupShown, accepted: Sequence[ModelRevision] = ()) -> GroupView:
    """The joint diagnosis for people; ``accepted``: the revisions that are in force."""
    return GroupView(
        heading=say("Diagnosis {sessions}", sessions=uncapitalised(over(shown.sessions))),
        summary="" if shown.findings or not shown.sessions else SHARED if shown.structures else SOUND,
        left_out=shown.left_out,
        effects=tuple(_effect(finding, accepted) for finding in shown.findings),
        structures=shown.structures,
        terms=tuple(term_view(term, accepted) for term in shown.terms),
        error=latest_in_words(shown),
        gain=gain_in_words(shown.gain),
        notes=tuple(map(with_days, shown.notes)),
        limits=tuple(_limit(limit) for limit in shown.limits if limit.amplitude),
    )


def _effect(finding: GroupFinding, accepted: Sequence[ModelRevision]) -> LastingEffect:
    scope = SCOPES[finding.level]
    return LastingEffect(
        cause=finding.cause,
        sensors=finding.sensors,
        whose=say("{scope} {subject}", scope=scope, subject=finding.subject),
        accepted=tuple(r.id for r in accepted if holds(r, finding)),
        statement=statement(finding),
        amplitudes=tuple(amplitudes_of(finding)),
        since=since_in_words(finding.form, finding.since),
        spread=_spread(finding) if finding.form == "varying" else "",
        evidence=say("{strength} over all of them", strength=standard_errors(finding.strength)),
        advice=RULE_OUT if finding.alternatives else finding.advice,
        choices=tuple(map(_choice, finding.rivals)),
        rows=tuple(_row(finding, session) for session in reversed(finding.sessions)),
    )


def _spread(finding: GroupFinding) -> str:
    """The largest scatter among its sensors, or among its effects."""
    largest = max(finding.spread, default=0.0)
    return measured(largest, None, amplitude_measure(finding.cause, finding.units[0], largest))


def holds(revision: ModelRevision, finding: GroupFinding) -> bool:
    """Whether a revision accepted a group's finding."""
    key = (revision.scope, revision.subject, revision.cause)
    theirs = (SCOPES[finding.level], finding.subject, finding.cause)
    return key == theirs and set(finding.sensors) <= set(revision.sensors)


def _choice(rival: GroupRival) -> GroupChoice:
    level = "" if rival.level == "unit" else say(", of the {level} {subject}", level=rival.level, subject=rival.subject)
    count = "" if rival.sessions is None else say_count(", {n} such session", ", {n} such sessions", rival.sessions)
    sensors = () if "*" in rival.sensors else rival.sensors
    measurement = (
        joined("", (rival.measurement, count)) if rival.measurement else "no planned session can separate them"
    )
    return GroupChoice(joined("", (cause_on(rival.cause, sensors), level)), percent(rival.probability), measurement)


def _row(finding: GroupFinding, session: SessionAmplitude) -> ForestRow:
    in_session = replace(finding, amplitude=session.amplitude, sigma=session.sigma)
    day = BLIND if session.started_at is None else day_in_words(session.started_at)
    return ForestRow(day, session.unit, joined("; ", amplitudes_of(in_session)) or BLIND)


def _limit(limit: PoolLimit) -> tuple[str, str, str]:
    single = replace(limit, amplitude=limit.one_session)
    of_one = size_of(single, ACCELEROMETER) if single.amplitude else BLIND
    return cause_on(limit.cause, ()), size_of(limit, ACCELEROMETER), of_one


def with_days(note: str) -> str:
    """A note with its moments as days."""
    if isinstance(note, Message):
        parts = {name: with_days(part) for name, part in note.parts.items()}
        return Message(note.template, parts, note.many, note.number)
    return day_in_words(note) if MOMENT.fullmatch(note) else MOMENT.sub(lambda found: day_in_words(found.group()), note)


def since_in_words(form: str, since: str | None) -> str:
    """The sessions that have an effect, in words."""
    return FORMS.get(form) or (
        "since one of these sessions" if since is None else say("since {date}", date=day_in_words(since))
    )


def day_in_words(started_at: str) -> str:
    """The day of a start as stated in a file: ``3 May 2026``."""
    return day_of(moment(started_at))
