"""Engineers accept causes and findings of groups into models, and withdraw them.

The size of a group's finding is the group's: no session fits it again. The model that it becomes part of was found with
it.

An accepted cause enters the stored sessions that it concerns, and a withdrawn one is taken out of them: they are
computed again in the background.
"""

from dataclasses import replace
from datetime import datetime
from math import exp, hypot

from estimator.causes import find
from estimator.diagnosis import Finding
from estimator.errors import problem_at
from estimator.groups import GroupFinding
from estimator.groups.fixed import EMPIRICAL
from estimator.groups.results import EmpiricalTerm
from estimator.message import joined, say
from service.diagnosis.records import StoredDiagnosis
from service.diagnosis.words.causes import UNKNOWN_CAUSE, cause_on
from service.errors import ConflictError, RefusedError
from service.groups.changes import tell_own
from service.groups.records import Group, GroupShown
from service.groups.store import read_group
from service.groups.words import equation_of
from service.jobs.changes import add_model_job
from service.kit.copying import copied
from service.models.records import SCOPES, AcceptedFinding, ModelRevision, NewLasting, NewModel, Pooled, Scope
from service.models.rules import in_force
from service.models.store import Models, Recomputations
from service.records.flagging.acts import Occasion
from service.records.flagging.fold import settle_sessions
from service.records.flagging.lasting import settle_accepted
from service.records.refresh_group import current, members_of
from service.sessions.records import DiagnosisState, StoredSession
from service.sessions.store import Sessions
from service.storage import Storage
from service.storage.audit import Audit
from service.storage.queries import Store
from service.types.store import UnitTypes
from service.units.store import Units


def accept_model(storage: Storage, diagnosis: StoredDiagnosis, new: NewModel, now: datetime) -> ModelRevision:
    """Adds a numbered revision with its evidence, resolves the flags that the cause explains, and asks for every
    session that it concerns to be computed again.

    RefusedError where the session does not show the cause, ConflictError where it could not be diagnosed.
    """
    if diagnosis.state is DiagnosisState.FAILED:
        raise ConflictError(diagnosis.summary)
    if diagnosis.found is None:
        raise _not_shown(new.cause, ())
    finding = _finding(diagnosis.found.findings, new.cause)
    with storage.database.writing() as store:
        session = Sessions(store).get(diagnosis.session)
        unit_type = UnitTypes(store).of_unit(session.unit).name
        accepted = ModelRevision(
            id=0,
            scope=new.scope,
            subject=_subject(new, session, unit_type, finding.sensors),
            cause=new.cause,
            sensors=finding.sensors,
            session=session.id,
            evidence=copied(AcceptedFinding, finding, gain=diagnosis.found.gain, pooled=None),
            accepted_by=new.by,
            note=new.note,
            accepted_at=now,
        )
        revision = Models(store).add(accepted)
        tell_own(store, revision.scope, revision.subject)
        _compute_again(store, revision, now)
        settle_sessions(store, Occasion(Units(store).hold(session.unit), session.id, now))
        details = {"cause": new.cause, "sensors": list(finding.sensors), "session": session.id, "note": new.note}
        Audit(store).write(
            now,
            new.by,
            "accept model",
            say("{scope} {subject}", scope=new.scope, subject=revision.subject),
            {"revision": revision.id, **details},
        )
        return revision


def _compute_again(store: Store, changed: ModelRevision, now: datetime) -> int:
    """Asks for the sessions of every unit that a changed model concerns; returns how many units those are."""
    units = Recomputations(store).ask(changed.id, changed.scope, changed.subject, now)
    add_model_job(store, changed, units, now)
    return units


def _finding(findings: tuple[Finding, ...], wanted: str) -> Finding:
    """The finding that is accepted, under its own name or under that of an equal alternative.

    A finding of several sessions together is accepted from those, at the size found there.
    """
    findings = tuple(f for f in findings if f.over_sessions is None)
    named = [f for f in findings if f.cause == wanted]
    equal = [_as_alternative(f, wanted) for f in findings if wanted in f.alternatives and wanted != UNKNOWN_CAUSE]
    if not named and not equal:
        raise _not_shown(wanted, findings)
    known = find(wanted)
    if known is None or not known.can_be_modelled:
        raise _refused(
            "cause",
            "{wanted} concerns this record or a change since earlier sessions and cannot be part of a model; "
            "correct the record and upload it again, or service the unit",
            wanted=repr(wanted),
        )
    return (*named, *equal)[0]


def _as_alternative(finding: Finding, wanted: str) -> Finding:
    """The finding with the sensors of the alternative; its amplitude is another quantity and is left out."""
    sensors = next((s.sensors for s in finding.separations if s.cause == wanted), finding.sensors)
    return replace(finding, sensors=sensors, amplitude=(), sigma=(), units=(), nonlinear_each=({},))


def _subject(new: NewModel, session: StoredSession, unit_type: str, sensors: tuple[str, ...]) -> str:
    match new.scope:
        case Scope.UNIT:
            return session.unit
        case Scope.UNIT_TYPE:
            return unit_type
        case Scope.STAND:
            return _stand(session, sensors)


def _stand(session: StoredSession, sensors: tuple[str, ...]) -> str:
    if sensors:
        found = joined(" and ", sensors)
        raise _refused(
            "scope",
            "is 'stand', but the cause acts on {sensors}; accept it for the unit or the unit type",
            sensors=found,
        )
    if session.stand is None:
        raise _refused("scope", "is 'stand', but the session names no stand; accept it for the unit or the unit type")
    return session.stand


def _not_shown(wanted: str, findings: tuple[Finding, ...]) -> RefusedError:
    shown = ", ".join(f.cause for f in findings) or "none"
    return _refused(
        "cause", "{cause} is not among the causes that this session shows ({known})", cause=repr(wanted), known=shown
    )


def _refused(field: str, message: str, /, **parts: object) -> RefusedError:
    return RefusedError("The cause cannot be accepted.", (problem_at(field, message, **parts),))


MOST = 700.0
"""ln of the largest number that a double holds, about."""
NOT_MADE = "What these sessions show together is being computed with their latest records: request it, then accept."


def accept_lasting(storage: Storage, group: Group, new: NewLasting, now: datetime) -> ModelRevision:
    """Adds a numbered revision with its evidence, and asks for every session that it concerns to be computed again.

    RefusedError where the group does not show the cause, ConflictError where its answer is not of its sessions of now.
    """
    with storage.database.writing() as store:
        answer = current(store, group)
        if answer is None or answer.document is None:
            raise ConflictError(NOT_MADE)
        shown = read_group(answer.document)
        taken = _term(shown, new) if new.cause == EMPIRICAL else _lasting_finding(shown, new)
        scope = SCOPES[taken.level]
        revision = Models(store).add(
            ModelRevision(
                id=0,
                scope=scope,
                subject=taken.subject,
                cause=new.cause,
                sensors=taken.sensors,
                session=members_of(store, group).pooled[-1].session,
                evidence=term_evidence(taken, shown) if isinstance(taken, EmpiricalTerm) else evidence_of(taken, shown),
                accepted_by=new.by,
                note=new.note,
                accepted_at=now,
            )
        )
        if isinstance(taken, GroupFinding):
            settle_accepted(store, revision, taken, now)
        tell_own(store, scope, taken.subject)
        units = _compute_again(store, revision, now)
        details = {"revision": revision.id, "cause": new.cause, "sensors": list(taken.sensors), "units": units}
        shows = {
            "group": say("{scopes} {name}", scopes=SCOPES[group.level.value], name=group.name),
            "sessions": shown.sessions,
            "note": new.note,
        }
        Audit(store).write(
            now, new.by, "accept model", say("{scope} {subject}", scope=scope, subject=taken.subject), details | shows
        )
        return revision


def evidence_of(finding: GroupFinding, shown: GroupShown) -> AcceptedFinding:
    """The finding as a revision keeps it; 1/e bounds the probability of such evidence without an effect (Markov)."""
    gain = shown.gain
    return copied(
        AcceptedFinding,
        finding,
        p_value=min(1.0, 1 / finding.e_value),
        sigma=tuple(float("nan") if sigma is None else sigma for sigma in finding.sigma),
        nonlinear={} if finding.shape is None else {"s": finding.shape},
        gain=None,
        pooled=copied(
            Pooled,
            finding,
            sessions=shown.sessions,
            first=shown.first,
            last=shown.last,
            fitted=0 if gain is None else gain.fitted,
            held_out=0 if gain is None else gain.held_out,
            log_score=None if gain is None else gain.log_score,
            words=(),
        ),
    )


def term_evidence(term: EmpiricalTerm, shown: GroupShown) -> AcceptedFinding:
    """A learned term as a revision keeps it: its evidence is its gain on the sessions without part in the fit."""
    return AcceptedFinding(
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
    found = [t for t in shown.terms if t.level and t.subject and new.sensors in ((), t.sensors)]
    if len(found) == 1:
        return found[0]
    if found:
        raise _refused("sensors", "must state which term: several were learned from these sessions")
    raise _refused("cause", "no term was learned from these sessions")


def _lasting_finding(shown: GroupShown, new: NewLasting) -> GroupFinding:
    found = [f for f in shown.findings if f.cause == new.cause and new.sensors in ((), f.sensors)]
    if len(found) == 1 and not found[0].subject:
        raise _refused(
            "cause", "{cause} belongs to a stand or a type, and the sessions name none", cause=repr(new.cause)
        )
    if len(found) == 1:
        return found[0]
    if found:
        places = joined(" or ", (", ".join(f.sensors) or "none" for f in found))
        raise _refused(
            "sensors",
            "must state which one: these sessions show {cause} on {places}",
            cause=repr(new.cause),
            places=places,
        )
    names = joined(", ", (cause_on(f.cause, f.sensors) for f in shown.findings)) or "none"
    raise _refused(
        "cause",
        "{cause} is not among the causes that these sessions show together ({names})",
        cause=repr(new.cause),
        names=names,
    )


def withdraw_model(storage: Storage, revision: int, by: str, why: str, now: datetime) -> ModelRevision:
    """Adds the revision that withdraws another; ConflictError where that one is not in force."""
    with storage.database.writing() as store:
        known = Models(store).get(revision)
        if known not in in_force(Models(store).of_subject(known.scope, known.subject)):
            raise ConflictError("Revision {id} is not in force: withdrawn before, or a withdrawal itself.", id=known.id)
        made = Models(store).add(
            replace(known, evidence=None, accepted_by=by, note=why, accepted_at=now, withdraws=known.id)
        )
        tell_own(store, known.scope, known.subject)
        _compute_again(store, made, now)
        details = {"revision": made.id, "withdraws": known.id, "cause": known.cause, "why": why}
        Audit(store).write(
            now, by, "withdraw model", say("{scope} {subject}", scope=known.scope, subject=known.subject), details
        )
        return made
