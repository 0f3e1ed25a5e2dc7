"""Flow: an engineer accepts what a group of sessions shows; every session that it concerns is computed again.

The size is the group's: no session fits it again. Whose model it becomes part of was found with it.
"""

from datetime import datetime

from estimator.errors import Problem
from estimator.groups import GroupFinding
from service.errors import ConflictError, RefusedError
from service.flows.flagging.lasting import settle_accepted
from service.flows.refresh_group import current, members_of
from service.records.group import Group, GroupShown
from service.records.model import Evidence, ModelRevision, NewLasting, Pooled
from service.storage import Storage
from service.storage.group_document import read_group
from service.storage.store import Store
from service.words.causes import cause_on
from service.words.group_finding import SCOPES

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
        finding = _finding(shown, new)
        scope = SCOPES[finding.level]
        revision = store.models.add(
            ModelRevision(
                id=0,
                scope=scope,
                subject=finding.subject,
                cause=finding.cause,
                sensors=finding.sensors,
                session=_latest(store, group),
                evidence=evidence_of(finding, shown),
                accepted_by=new.by,
                note=new.note,
                accepted_at=now,
            )
        )
        settle_accepted(store, revision, finding, now)
        units = store.recomputations.ask(revision.id, scope, finding.subject, now)
        details = {"revision": revision.id, "cause": finding.cause, "sensors": list(finding.sensors), "units": units}
        shows = {"group": f"{SCOPES[group.level.value]} {group.name}", "sessions": shown.sessions, "note": new.note}
        store.audit.write(now, new.by, "accept model", f"{scope} {finding.subject}", details | shows)
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
            first=shown.first or "",
            last=shown.last or "",
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
