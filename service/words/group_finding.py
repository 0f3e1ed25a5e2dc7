"""A lasting effect in words: how large, since when, told from what, and in which sessions."""

from dataclasses import dataclass, replace
from datetime import datetime

from estimator.groups import GroupFinding
from estimator.groups.results import PoolLimit, Rival, SessionAmplitude
from estimator.session import ACCELEROMETER
from service.records.group import GroupAnswer, GroupShown
from service.words.amplitudes import amplitudes_of
from service.words.causes import cause_on, percent
from service.words.finding import standard_errors
from service.words.group import over, statement
from service.words.limits import size_of
from service.words.names import day_of

FORMS = {
    "same": "in all of these sessions",
    "varying": "in these sessions, but different every time",
}
BLIND = "–"
"""In place of a size that no number of such sessions shows."""


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
    equations: tuple[str, ...]
    notes: tuple[str, ...]
    limits: tuple[tuple[str, str, str], ...]
    """Cause, the smallest size that the pool would find, and that one session would."""


def group_view(answer: GroupAnswer, shown: GroupShown) -> GroupView:
    """What a technician and an engineer read of a group's answer."""
    return GroupView(
        heading=f"What the simulation gets wrong, {over(shown.sessions).lower()}",
        summary=answer.summary.partition(": ")[2].capitalize() if not shown.findings else "",
        left_out=shown.left_out,
        effects=tuple(map(_effect, shown.findings)),
        equations=shown.equations,
        notes=shown.notes,
        limits=tuple(_limit(limit) for limit in shown.limits if limit.pool.amplitude),
    )


def _effect(finding: GroupFinding) -> LastingEffect:
    since = FORMS.get(finding.form) or f"since {_day(finding.since or '')}"
    return LastingEffect(
        statement=statement(finding),
        amplitudes=tuple(amplitudes_of(finding)),
        since=since,
        evidence=f"{standard_errors(finding.strength)} over all of them",
        advice=RULE_OUT if finding.alternatives else finding.advice,
        choices=tuple(map(_choice, finding.rivals)),
        rows=tuple(_row(finding, one) for one in reversed(finding.sessions)),
    )


def _choice(rival: Rival) -> Choice:
    whose = "" if rival.level == "unit" else f", of the {rival.level} {rival.subject}"
    count = "" if rival.sessions is None else f", {rival.sessions} such session{'' if rival.sessions == 1 else 's'}"
    sensors = () if "*" in rival.sensors else rival.sensors
    told = f"{rival.measurement}{count}" if rival.measurement else "nothing that can be planned"
    return Choice(f"{cause_on(rival.cause, sensors)}{whose}", percent(rival.probability), told)


def _row(finding: GroupFinding, one: SessionAmplitude) -> ForestRow:
    own = replace(finding, amplitude=one.amplitude, sigma=one.sigma)
    return ForestRow(_day(one.started_at), one.unit, "; ".join(amplitudes_of(own)) or BLIND)


def _limit(limit: PoolLimit) -> tuple[str, str, str]:
    of_one = size_of(limit.session, ACCELEROMETER) if limit.session.amplitude else BLIND
    return cause_on(limit.pool.cause, ()), size_of(limit.pool, ACCELEROMETER), of_one


def _day(started_at: str) -> str:
    return day_of(datetime.fromisoformat(started_at))
