"""Flow: an engineer accepts what a group of sessions shows; every session that it concerns is computed again.

The size is the group's: no session fits it again. Whose model it becomes part of was found with it.
"""

from datetime import datetime
from math import exp, hypot

from estimator.errors import Problem
from estimator.groups import GroupFinding
from estimator.groups.fixed import EMPIRICAL
from estimator.groups.results import EmpiricalTerm
from service.errors import ConflictError, RefusedError
from service.flows.ask_job import tell_job
from service.flows.flagging.lasting import settle_accepted
from service.flows.own_of_group import tell_own
from service.flows.refresh_group import current, members_of
from service.records.group import Group, GroupShown
from service.records.model import SCOPES, Evidence, ModelRevision, NewLasting, Pooled
from service.storage import Storage
from service.storage.group_document import read_group
from service.storage.store import Store
from service.words.causes import cause_on
from service.words.learned_term import equation_of

MOST = 700.0
"""ln of the largest number that a double holds, about."""
NOT_MADE = "What these sessions show together is being worked out with their latest records: ask for it, then accept."


def accept_lasting(storage: Storage, group: Group, new: NewLasting, now: datetime) -> ModelRevision:
    """Adds a numbered revision with its evidence, and asks for every session that it concerns to be computed again.

    RefusedError where the group does not show the cause, ConflictError where its answer is not of its sessions of now.
    """
    with storage.database.writing() as store:
        answer = current(store, group)
        if answer is None or answer.document is None:
            raise ConflictError(NOT_MADE)
        shown = read_group(answer.document)
        taken = _term(shown, new) if new.cause == EMPIRICAL else _finding(shown, new)
        scope = SCOPES[taken.level]
        revision = store.models.add(
            ModelRevision(
                id=0,
                scope=scope,
                subject=taken.subject,
                cause=new.cause,
                sensors=taken.sensors,
                session=_latest(store, group),
                evidence=term_evidence(taken, shown) if isinstance(taken, EmpiricalTerm) else evidence_of(taken, shown),
                accepted_by=new.by,
                note=new.note,
                accepted_at=now,
            )
        )
        if isinstance(taken, GroupFinding):
            settle_accepted(store, revision, taken, now)
        tell_own(store, scope, taken.subject)
        units = store.recomputations.ask(revision.id, scope, taken.subject, now)
        tell_job(store, revision, units, now)
        details = {"revision": revision.id, "cause": new.cause, "sensors": list(taken.sensors), "units": units}
        shows = {"group": f"{SCOPES[group.level.value]} {group.name}", "sessions": shown.sessions, "note": new.note}
        store.audit.write(now, new.by, "accept model", f"{scope} {taken.subject}", details | shows)
        return revision


def evidence_of(finding: GroupFinding, shown: GroupShown) -> Evidence:
    """The finding as a revision keeps it; 1/e bounds the probability of such evidence without an effect (Markov)."""
    gain = shown.gain
    return Evidence(
        p_value=min(1.0, 1 / finding.e_value),
        strength=finding.strength,
        amplitude=finding.amplitude,
        sigma=tuple(float("nan") if sigma is None else sigma for sigma in finding.sigma),
        units=finding.units,
        nonlinear={} if finding.shape is None else {"s": finding.shape},
        alternatives=finding.alternatives,
        sentence=finding.sentence,
        gain=None,
        pooled=Pooled(
            sessions=shown.sessions,
            first=shown.first,
            last=shown.last,
            form=finding.form,
            since=finding.since,
            kind=finding.kind,
            shape=finding.shape,
            spread=finding.spread,
            e_value=finding.e_value,
            fitted=0 if gain is None else gain.fitted,
            held_out=0 if gain is None else gain.held_out,
            log_score=None if gain is None else gain.log_score,
        ),
    )


def term_evidence(term: EmpiricalTerm, shown: GroupShown) -> Evidence:
    """A learned term as a revision keeps it: its evidence is what it gains on the sessions that took no part."""
    return Evidence(
        p_value=min(1.0, exp(-max(term.gain, 0.0))),
        strength=hypot(*(a / s for a, s in zip(term.amplitude, term.sigma, strict=True))),
        amplitude=term.amplitude,
        sigma=term.sigma,
        units=term.units,
        nonlinear={},
        alternatives=(),
        sentence=equation_of(term),
        gain=None,
        pooled=Pooled(
            sessions=shown.sessions,
            first=shown.first,
            last=shown.last,
            form="same",
            since=None,
            kind="",
            shape=None,
            spread=(0.0,),
            e_value=exp(min(term.gain, MOST)),
            fitted=0,
            held_out=0,
            log_score=term.gain,
            words=term.words,
        ),
    )


def _term(shown: GroupShown, new: NewLasting) -> EmpiricalTerm:
    """The learned term that is meant."""
    found = [t for t in shown.terms if t.level and t.subject and new.sensors in ((), t.sensors)]
    if len(found) == 1:
        return found[0]
    if found:
        raise _refused("sensors", "must say which is meant: these sessions taught several terms")
    raise _refused("cause", "no term was learned from these sessions")


def _finding(shown: GroupShown, new: NewLasting) -> GroupFinding:
    """The one that is meant."""
    found = [f for f in shown.findings if f.cause == new.cause and new.sensors in ((), f.sensors)]
    if len(found) == 1 and not found[0].subject:
        raise _refused("cause", f"{new.cause!r} belongs to a stand or a type, and the sessions name none")
    if len(found) == 1:
        return found[0]
    if found:
        places = " or ".join(", ".join(f.sensors) or "none" for f in found)
        raise _refused("sensors", f"must say which is meant: these sessions show {new.cause!r} on {places}")
    names = ", ".join(cause_on(f.cause, f.sensors) for f in shown.findings) or "none"
    raise _refused("cause", f"{new.cause!r} is not among the causes that these sessions show together ({names})")


def _latest(store: Store, group: Group) -> str:
    return members_of(store, group).pooled[-1].session


def _refused(field: str, message: str) -> RefusedError:
    return RefusedError("The cause cannot be accepted.", (Problem(field, message),))
