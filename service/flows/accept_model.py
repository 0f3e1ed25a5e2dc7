"""Flow: an engineer accepts a named cause; from then on it is part of the model of a unit, unit type or stand."""

from dataclasses import replace
from datetime import datetime

from estimator.causes import find
from estimator.diagnosis import Finding
from estimator.diagnosis.results import Gain
from estimator.errors import Problem
from service.errors import ConflictError, RefusedError
from service.flows.own_of_group import tell_own
from service.records.diagnosis import DiagnosisState, StoredDiagnosis
from service.records.model import Evidence, ModelRevision, NewModel, Scope
from service.records.session import StoredSession
from service.storage import Storage
from service.words.causes import UNKNOWN_CAUSE


def accept_model(storage: Storage, diagnosis: StoredDiagnosis, new: NewModel, now: datetime) -> ModelRevision:
    """Adds a numbered revision with its evidence; RefusedError where the session does not show the cause, ConflictError
    where it could not be diagnosed."""
    if diagnosis.state is DiagnosisState.FAILED:
        raise ConflictError(diagnosis.summary)
    if diagnosis.found is None:
        raise _not_shown(new.cause, ())
    finding = _finding(diagnosis.found.findings, new.cause)
    with storage.database.writing() as store:
        session = store.sessions.get(diagnosis.session)
        unit_type = store.unit_types.of_unit(session.unit).name
        accepted = ModelRevision(
            id=0,
            scope=new.scope,
            subject=_subject(new, session, unit_type, finding.sensors),
            cause=new.cause,
            sensors=finding.sensors,
            session=session.id,
            evidence=_evidence(finding, diagnosis.found.gain),
            accepted_by=new.by,
            note=new.note,
            accepted_at=now,
        )
        revision = store.models.add(accepted)
        tell_own(store, revision.scope, revision.subject)
        details = {"cause": new.cause, "sensors": list(finding.sensors), "session": session.id, "note": new.note}
        store.audit.write(
            now, new.by, "accept model", f"{new.scope} {revision.subject}", {"revision": revision.id, **details}
        )
        return revision


def _finding(findings: tuple[Finding, ...], wanted: str) -> Finding:
    """The finding that is accepted, under its own name or under that of an equal alternative.

    What only several sessions show together is accepted from those, at the size that they found.
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
            f"{wanted!r} is a matter of this one record or of what changed since earlier sessions, not a property "
            "that a model can hold; correct the record and upload it again, or act on the unit",
        )
    return (*named, *equal)[0]


def _as_alternative(finding: Finding, wanted: str) -> Finding:
    """The finding with the sensors of the alternative; its amplitude is another quantity and is left out."""
    sensors = next((s.sensors for s in finding.separations if s.cause == wanted), finding.sensors)
    return replace(finding, sensors=sensors, amplitude=(), sigma=(), units=(), nonlinear_each=({},))


def _evidence(finding: Finding, gain: Gain) -> Evidence:
    return Evidence(
        p_value=finding.p_value,
        strength=finding.strength,
        amplitude=finding.amplitude,
        sigma=finding.sigma,
        units=finding.units,
        nonlinear=finding.nonlinear,
        alternatives=finding.alternatives,
        sentence=finding.sentence,
        gain=gain,
    )


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
        found = " and ".join(sensors)
        raise _refused("scope", f"is 'stand', but the cause acts on {found}; accept it for the unit or the unit type")
    if session.stand is None:
        raise _refused("scope", "is 'stand', but the session names no stand; accept it for the unit or the unit type")
    return session.stand


def _not_shown(wanted: str, findings: tuple[Finding, ...]) -> RefusedError:
    shown = ", ".join(f.cause for f in findings) or "none"
    return _refused("cause", f"{wanted!r} is not among the causes that this session shows ({shown})")


def _refused(field: str, message: str) -> RefusedError:
    return RefusedError("The cause cannot be accepted.", (Problem(field, message),))
