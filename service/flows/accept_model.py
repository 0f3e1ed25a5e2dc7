"""Flow: an engineer accepts a named cause; from then on it is part of the model of a unit, unit type or stand."""

from datetime import datetime
from typing import Any

from estimator.causes import cause
from estimator.errors import Problem
from service.errors import RefusedError
from service.records.diagnosis import StoredDiagnosis
from service.records.model import ModelRevision, NewModel, Scope
from service.records.session import StoredSession
from service.storage import Storage

EVIDENCE = ("p_value", "strength", "amplitude", "sigma", "units", "nonlinear", "alternatives", "sentence")
"""What a revision keeps of the finding that it rests on."""


def accept_model(storage: Storage, diagnosis: StoredDiagnosis, new: NewModel, now: datetime) -> ModelRevision:
    """Adds a numbered revision with its evidence; RefusedError where the session does not show the cause."""
    finding = _finding(diagnosis, new)
    sensors = tuple(finding["sensors"])
    with storage.database.writing() as store:
        session = store.sessions.get(diagnosis.session)
        unit_type = store.unit_types.of_unit(session.unit).name
        subject = _subject(new, session, unit_type, sensors)
        evidence = {name: finding[name] for name in EVIDENCE} | {"gain": (diagnosis.document or {})["gain"]}
        revision = store.models.add(new, subject, sensors, session=session.id, evidence=evidence, at=now)
        details = {"cause": new.cause, "sensors": list(sensors), "session": session.id, "note": new.note}
        store.log.audit(now, new.by, "accept model", f"{new.scope} {subject}", {"revision": revision.id, **details})
        return revision


def _finding(diagnosis: StoredDiagnosis, new: NewModel) -> dict[str, Any]:
    """The finding that is accepted, under its own name or under that of an equal alternative."""
    findings: list[dict[str, Any]] = (diagnosis.document or {}).get("findings", [])
    named = [f for f in findings if f["cause"] == new.cause]
    equal = [f for f in findings if new.cause in f["alternatives"]]
    if not named and not equal:
        shown = ", ".join(f["cause"] for f in findings) or "none"
        raise _refused("cause", f"{new.cause!r} is not among the causes that this session shows ({shown})")
    if not cause(new.cause).can_be_modelled:
        raise _refused(
            "cause",
            f"{new.cause!r} is a matter of this one record or of what changed since earlier sessions, not a property "
            "that a model can hold; correct the record and upload it again, or act on the unit",
        )
    return named[0] if named else _as_alternative(equal[0], new.cause)


def _as_alternative(finding: dict[str, Any], cause: str) -> dict[str, Any]:
    """The finding with the sensors of the alternative; its amplitude is another quantity and is left out."""
    sensors = next((s["sensors"] for s in finding["separations"] if s["cause"] == cause), finding["sensors"])
    return {**finding, "sensors": sensors, "amplitude": [], "sigma": [], "units": [], "nonlinear": {}}


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


def _refused(field: str, message: str) -> RefusedError:
    return RefusedError("The cause cannot be accepted.", (Problem(field, message),))
