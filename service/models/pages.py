"""The page of an accepted cause and its forms."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Annotated
from urllib.parse import quote

from fastapi import APIRouter, Form, Request
from fastapi.responses import HTMLResponse, RedirectResponse

from estimator.groups.fixed import EMPIRICAL
from estimator.message import say
from service.diagnosis.words.amplitudes import Amounts, amplitudes_of
from service.diagnosis.words.causes import cause_on
from service.diagnosis.words.findings import standard_errors
from service.groups.records import Level
from service.groups.store import Groups
from service.groups.words import over, since_in_words
from service.models.records import ModelRevision, NewLasting, Pooled, Progress, Recomputation, Scope
from service.models.rules import in_force, pooled_of
from service.models.sections import gain_of
from service.models.store import Models, Recomputations
from service.models.words import left_in_words, moved_in_words, progress_of
from service.people.dependencies import SEE_OTHER, By, FormLines, FormText, Number, Why
from service.records.dependencies import ReceptionOf
from service.records.models import accept_lasting, withdraw_model
from service.records.recalibrate import recompute_beside
from service.sessions.words.conditions import Condition, condition_of
from service.web.dependencies import Now, Reading
from service.web.render import SOONEST, render

SUBJECT_PATHS = {Scope.UNIT: "/units/", Scope.UNIT_TYPE: "/unit-types/", Scope.STAND: "/stands/"}
"""Address of the page of a subject."""


@dataclass(frozen=True)
class MovedRow:
    """A session whose verdict changed."""

    session: str
    unit: str
    at: datetime
    before: Condition
    after: Condition


@dataclass(frozen=True)
class RecomputedRow:
    """Result for a unit's sessions."""

    unit: str
    sessions: str
    furthest: str


@dataclass(frozen=True)
class ModelView:
    """Contents of the page."""

    revision: ModelRevision
    name: str
    whose: str
    home: str
    """Address of the subject's page."""
    statement: str
    amplitudes: tuple[str, ...]
    evidence: str
    gain: str
    """Gain for its sensors, in one sentence."""
    withdrawn: ModelRevision | None
    holds: bool
    progress: str
    verdicts: tuple[MovedRow, ...]
    units: tuple[RecomputedRow, ...]
    follow: int | None
    """Seconds until the page refreshes; None once all is done."""


def model_page(
    revision: ModelRevision, of_subject: Sequence[ModelRevision], recomputations: Sequence[Recomputation]
) -> ModelView:
    """A revision among those of its subject, with its consequences."""
    evidence, pooled = revision.evidence, pooled_of(revision)
    return ModelView(
        revision=revision,
        name=cause_on(revision.cause, revision.sensors),
        whose=say("{scope} {subject}", scope=revision.scope, subject=revision.subject),
        home=f"{SUBJECT_PATHS[revision.scope]}{quote(revision.subject)}",
        statement="" if evidence is None else evidence.sentence,
        amplitudes=_amplitudes(revision),
        evidence="" if evidence is None else _evidence(evidence.strength, pooled),
        gain=gain_of(revision),
        withdrawn=next((r for r in of_subject if r.withdraws == revision.id), None),
        holds=revision in in_force(of_subject),
        progress=progress_of(recomputations),
        verdicts=tuple(_moved(recomputations)),
        units=tuple(map(_unit, recomputations)),
        follow=SOONEST if any(recomputation.state is Progress.WAITING for recomputation in recomputations) else None,
    )


def _amplitudes(revision: ModelRevision) -> tuple[str, ...]:
    evidence = revision.evidence
    if evidence is None or revision.cause == EMPIRICAL:  # the equation of a learned term states them
        return ()
    amounts = Amounts(revision.cause, revision.sensors, evidence.amplitude, evidence.sigma, evidence.units)
    return tuple(amplitudes_of(amounts))


def _evidence(strength: float, pooled: Pooled | None) -> str:
    """``Over 34 sessions, in all of these sessions: 12.3 standard errors.``"""
    if pooled is None:
        return say(
            "In one session: {strength}. Its size is estimated in each session.", strength=standard_errors(strength)
        )
    since = since_in_words(pooled.form, pooled.since)
    fitted = (
        "estimated from all sessions together" if pooled.form == "varying" else "not estimated again in single sessions"
    )
    parts = {"sessions": over(pooled.sessions), "since": since, "strength": standard_errors(strength), "fitted": fitted}
    return say("{sessions}, {since}: {strength}. Size from these sessions: {fitted}.", **parts)


def _moved(recomputations: Sequence[Recomputation]) -> Iterator[MovedRow]:
    for recomputation in recomputations:
        for verdict in () if recomputation.outcome is None else recomputation.outcome.verdicts:
            yield MovedRow(
                verdict.session,
                recomputation.unit,
                verdict.started_at,
                condition_of(verdict.before),
                condition_of(verdict.after),
            )


def _unit(recomputation: Recomputation) -> RecomputedRow:
    outcome = recomputation.outcome
    if outcome is None:
        return RecomputedRow(recomputation.unit, recomputation.state.value, left_in_words(recomputation))
    remainder = say(", {number} cannot be", number=outcome.left) if outcome.left else ""
    return RecomputedRow(
        recomputation.unit,
        say(
            "{recomputed} of {sessions}{remainder}",
            recomputed=outcome.recomputed,
            sessions=outcome.sessions,
            remainder=remainder,
        ),
        moved_in_words(outcome.furthest),
    )


router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)


@router.get("/models/{id}")
def show_model(request: Request, store: Reading, id: Number) -> HTMLResponse:
    """An accepted cause, how far its sessions are computed again, and what moved."""
    revision = Models(store).get(id)
    of_subject = Models(store).of_subject(revision.scope, revision.subject)
    return render(request, "model.html", model_page(revision, of_subject, Recomputations(store).of(id)))


@router.post("/groups/accept")
def accept(
    reception: ReceptionOf,
    now: Now,
    *,
    level: Annotated[Level, Form()],
    name: FormText,
    cause: FormText,
    sensors: Annotated[list[str], Form(default_factory=list, max_length=1000)],
    by: By,
    note: FormLines = "",
) -> RedirectResponse:
    """Accepts a finding of a group of sessions, and shows the results."""
    with reception.storage.database.reading() as store:
        group = Groups(store).find(level, name)
    accepted = accept_lasting(reception.storage, group, NewLasting(cause, tuple(sensors), by, note), now)
    recompute_beside(reception, now)
    return RedirectResponse(f"/models/{accepted.id}", SEE_OTHER)


@router.post("/models/{id}/withdraw")
def withdraw(id: Number, reception: ReceptionOf, now: Now, *, by: By, why: Why) -> RedirectResponse:
    """Takes an accepted cause out of the model again, and shows what that moves."""
    withdrawal = withdraw_model(reception.storage, id, by, why, now)
    recompute_beside(reception, now)
    return RedirectResponse(f"/models/{withdrawal.id}", SEE_OTHER)
