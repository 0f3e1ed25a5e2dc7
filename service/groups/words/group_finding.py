"""A lasting effect in words: how large, since when, told from what, and in which sessions."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from estimator.groups import GroupFinding
from estimator.groups.results import PoolLimit, Rival, SessionAmplitude
from estimator.message import Message, joined, say, say_count, uncapitalised
from estimator.moments import moment
from estimator.session import ACCELEROMETER
from service.diagnosis.words.amplitudes import amplitudes_of
from service.diagnosis.words.causes import cause_on, percent
from service.diagnosis.words.finding import standard_errors
from service.diagnosis.words.limits import size_of
from service.groups.records import GroupAnswer, GroupShown
from service.groups.words.group import SHARED, SOUND, over, statement
from service.groups.words.learned_term import TermView, gain_in_words, term_view
from service.kit.names import day_of
from service.models.records import SCOPES, ModelRevision

FORMS = {
    "same": "in all of these sessions",
    "varying": "in these sessions, but different every time",
}
MOMENT = re.compile(r"\d{4}-\d\d-\d\dT[\d:.]+(?:Z|[+-]\d\d:\d\d)?")
"""A moment as files state it, ISO 8601."""
BLIND = "–"
"""In place of a size that no number of such sessions shows, and of a date that is not known."""


RULE_OUT = "These sessions do not rule the others out. Take the measurement that would, before you act on one of them."


@dataclass(frozen=True)
class Choice:
    """What else it could be, and what would tell."""

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
    evidence: str
    advice: str
    choices: tuple[Choice, ...]
    rows: tuple[ForestRow, ...]
    """Newest first."""


@dataclass(frozen=True)
class GroupView:
    """What a group's sessions show together, for people."""

    heading: str
    summary: str
    left_out: int
    effects: tuple[LastingEffect, ...]
    structures: tuple[str, ...]
    """Where structure lives that no cause explains."""
    terms: tuple[TermView, ...]
    gain: str
    notes: tuple[str, ...]
    limits: tuple[tuple[str, str, str], ...]
    """Cause, the smallest size that the pool would find, and that one session would."""


def group_view(answer: GroupAnswer, shown: GroupShown, accepted: Sequence[ModelRevision] = ()) -> GroupView:
    """What a technician and an engineer read of a group's answer; ``accepted``: the revisions that are in force."""
    return GroupView(
        heading=say("What the simulation gets wrong, {sessions}", sessions=uncapitalised(over(shown.sessions))),
        summary="" if shown.findings or not shown.sessions else SHARED if shown.structures else SOUND,
        left_out=shown.left_out,
        effects=tuple(_effect(finding, accepted) for finding in shown.findings),
        structures=shown.structures,
        terms=tuple(term_view(term, accepted) for term in shown.terms),
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
        evidence=say("{strength} over all of them", strength=standard_errors(finding.strength)),
        advice=RULE_OUT if finding.alternatives else finding.advice,
        choices=tuple(map(_choice, finding.rivals)),
        rows=tuple(_row(finding, one) for one in reversed(finding.sessions)),
    )


def holds(revision: ModelRevision, finding: GroupFinding) -> bool:
    """Whether a revision accepted what a group shows."""
    own = (revision.scope, revision.subject, revision.cause)
    theirs = (SCOPES[finding.level], finding.subject, finding.cause)
    return own == theirs and set(finding.sensors) <= set(revision.sensors)


def _choice(rival: Rival) -> Choice:
    whose = "" if rival.level == "unit" else say(", of the {level} {subject}", level=rival.level, subject=rival.subject)
    count = "" if rival.sessions is None else say_count(", {n} such session", ", {n} such sessions", rival.sessions)
    sensors = () if "*" in rival.sensors else rival.sensors
    told = joined("", (rival.measurement, count)) if rival.measurement else "nothing that can be planned"
    return Choice(joined("", (cause_on(rival.cause, sensors), whose)), percent(rival.probability), told)


def _row(finding: GroupFinding, one: SessionAmplitude) -> ForestRow:
    own = replace(finding, amplitude=one.amplitude, sigma=one.sigma)
    day = BLIND if one.started_at is None else day_in_words(one.started_at)
    return ForestRow(day, one.unit, joined("; ", amplitudes_of(own)) or BLIND)


def _limit(limit: PoolLimit) -> tuple[str, str, str]:
    one = replace(limit, amplitude=limit.one_session)
    of_one = size_of(one, ACCELEROMETER) if one.amplitude else BLIND
    return cause_on(limit.cause, ()), size_of(limit, ACCELEROMETER), of_one


def with_days(note: str) -> str:
    """A note with its moments as days."""
    if isinstance(note, Message):
        parts = {name: with_days(part) for name, part in note.parts.items()}
        return Message(note.template, parts, note.many, note.number)
    return day_in_words(note) if MOMENT.fullmatch(note) else MOMENT.sub(lambda found: day_in_words(found.group()), note)


def since_in_words(form: str, since: str | None) -> str:
    """In which of the sessions an effect is."""
    return FORMS.get(form) or (
        "since one of these sessions" if since is None else say("since {since}", since=day_in_words(since))
    )


def day_in_words(started_at: str) -> str:
    """``3 May 2026`` of what a file states."""
    return day_of(moment(started_at))
