"""The page of an accepted cause: what was accepted, on what evidence, and what it moved in which session."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from urllib.parse import quote

from estimator.groups.fixed import EMPIRICAL
from service.judging.model_in_force import in_force, pooled_of
from service.pages.follow import SOONEST
from service.records.model import ModelRevision, Pooled, Scope
from service.records.recomputation import Progress, Recomputation
from service.words.amplitudes import Amounts, amplitudes_of
from service.words.causes import cause_on
from service.words.conditions import Condition, condition_of
from service.words.finding import standard_errors
from service.words.group import over
from service.words.group_finding import since_in_words
from service.words.recomputations import left_in_words, moved_in_words, progress_of

HOMES = {Scope.UNIT: "/units/", Scope.UNIT_TYPE: "/unit-types/", Scope.STAND: "/stands/"}
"""Where the page of a subject is."""


@dataclass(frozen=True)
class MovedRow:
    """A session with another verdict since."""

    session: str
    unit: str
    at: datetime
    before: Condition
    after: Condition


@dataclass(frozen=True)
class UnitRow:
    """What became of a unit's sessions."""

    unit: str
    sessions: str
    furthest: str


@dataclass(frozen=True)
class ModelPage:
    """Everything the page shows."""

    revision: ModelRevision
    name: str
    whose: str
    home: str
    """Address of whose model it is."""
    statement: str
    amplitudes: tuple[str, ...]
    evidence: str
    withdrawn: ModelRevision | None
    """That took it out again."""
    holds: bool
    progress: str
    verdicts: tuple[MovedRow, ...]
    units: tuple[UnitRow, ...]
    follow: int | None
    """Seconds until the page reads itself again; None once all is done."""


def model_page(
    revision: ModelRevision, of_subject: Sequence[ModelRevision], found: Sequence[Recomputation]
) -> ModelPage:
    """Of a revision among those of its subject, with what it brought."""
    evidence, pooled = revision.evidence, pooled_of(revision)
    return ModelPage(
        revision=revision,
        name=cause_on(revision.cause, revision.sensors),
        whose=f"{revision.scope} {revision.subject}",
        home=f"{HOMES[revision.scope]}{quote(revision.subject)}",
        statement="" if evidence is None else evidence.sentence,
        amplitudes=_amplitudes(revision),
        evidence="" if evidence is None else _evidence(evidence.strength, pooled),
        withdrawn=next((r for r in of_subject if r.withdraws == revision.id), None),
        holds=revision in in_force(of_subject),
        progress=progress_of(found),
        verdicts=tuple(_moved(found)),
        units=tuple(map(_unit, found)),
        follow=SOONEST if any(one.state is Progress.WAITING for one in found) else None,
    )


def _amplitudes(revision: ModelRevision) -> tuple[str, ...]:
    evidence = revision.evidence
    if evidence is None or revision.cause == EMPIRICAL:  # the equation of a learned term states them
        return ()
    own = Amounts(revision.cause, revision.sensors, evidence.amplitude, evidence.sigma, evidence.units)
    return tuple(amplitudes_of(own))


def _evidence(strength: float, pooled: Pooled | None) -> str:
    """``Over 34 sessions, in all of these sessions: 12.3 standard errors.``"""
    if pooled is None:
        return f"In one session: {standard_errors(strength)}. Each session fits its own size."
    since = since_in_words(pooled.form, pooled.since)
    fitted = "each session has a say in it" if pooled.form == "varying" else "no session fits it again"
    return f"{over(pooled.sessions)}, {since}: {standard_errors(strength)}. The size is theirs: {fitted}."


def _moved(found: Sequence[Recomputation]) -> Iterator[MovedRow]:
    for one in found:
        for m in () if one.outcome is None else one.outcome.verdicts:
            yield MovedRow(m.session, one.unit, m.started_at, condition_of(m.before), condition_of(m.after))


def _unit(one: Recomputation) -> UnitRow:
    told = one.outcome
    if told is None:
        return UnitRow(one.unit, one.state.value, left_in_words(one))
    left = f", {told.left} cannot be" if told.left else ""
    return UnitRow(one.unit, f"{told.recomputed} of {told.sessions}{left}", moved_in_words(told.furthest))
