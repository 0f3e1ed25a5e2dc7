"""Step: concerns that an engineer's accepted causes explain.

A concern is explained where every sensor on which it acts has, in the model in force, one of the causes that may be
behind it. What is explained is known: it raises no flag and resolves the open one.
"""

from collections.abc import Iterable

from estimator.groups.layout import EVERY
from estimator.message import say
from service.flags.records import Concern
from service.judging.records import SessionEvidence
from service.models.records import ModelRevision, Scope
from service.models.rules import in_force, pooled_of
from service.models.store import Models
from service.storage.queries import Store

ACCEPTED = "Accepted into the model of {whose}, revision {revision}."


def accepted_in_words(revision: ModelRevision) -> str:
    """Reason for resolving a flag whose matter an accepted cause explains."""
    whose = say("{scope} {subject}", scope=revision.scope, subject=revision.subject)
    return say(ACCEPTED, whose=whose, revision=revision.id)


class AcceptedCauses:
    """Accepted causes in force, by unit."""

    def __init__(self, store: Store, sessions: Iterable[SessionEvidence]) -> None:
        """Reads the models of the units whose diagnoses name causes."""
        units = {session.unit for session in sessions for concern in _diagnosed(session) if concern.causes}
        self._of_unit = {unit: in_force(Models(store).of_unit(unit)) for unit in sorted(units)}

    def explain(self, unit: str, concern: Concern) -> ModelRevision | None:
        """The latest revision of those that explain a concern; None where they leave any of it open."""
        revisions = [r for r in self._of_unit.get(unit, ()) if r.cause in concern.causes]
        if not concern.sensors:
            ours = (
                r for r in revisions if not r.sensors and (r.scope is not Scope.STAND or r.subject == concern.place)
            )
            return max(ours, key=lambda revision: revision.id, default=None)
        each = [[r for r in revisions if _acts_on(r, *sensor)] for sensor in concern.sensors]
        if not all(each):
            return None
        return max((r for found in each for r in found), key=lambda revision: revision.id)


def _diagnosed(session: SessionEvidence) -> tuple[Concern, ...]:
    return () if session.diagnosis is None else session.diagnosis.concerns


def _acts_on(revision: ModelRevision, sensor: str, kind: str) -> bool:
    pooled = pooled_of(revision)
    is_every = EVERY in revision.sensors and pooled is not None and pooled.kind == kind
    return is_every or sensor in revision.sensors
