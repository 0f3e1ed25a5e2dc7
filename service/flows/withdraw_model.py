"""Flow: an engineer withdraws an accepted cause; a new revision says so, and the old one stays on record.

What a group of sessions showed goes out of every session that it concerned.
"""

from dataclasses import replace
from datetime import datetime

from service.errors import ConflictError
from service.flows.ask_job import tell_job
from service.flows.own_of_group import tell_own
from service.judging.model_in_force import in_force, pooled_of
from service.records.model import ModelRevision
from service.storage import Storage


def withdraw_model(storage: Storage, revision: int, by: str, why: str, now: datetime) -> ModelRevision:
    """Adds the revision that withdraws another; ConflictError where that one is not in force."""
    with storage.database.writing() as store:
        known = store.models.get(revision)
        if known not in in_force(store.models.of_subject(known.scope, known.subject)):
            raise ConflictError(f"Revision {known.id} is not in force: withdrawn before, or a withdrawal itself.")
        made = store.models.add(
            replace(known, evidence=None, accepted_by=by, note=why, accepted_at=now, withdraws=known.id)
        )
        tell_own(store, known.scope, known.subject)
        if pooled_of(known) is not None:
            tell_job(store, made, store.recomputations.ask(made.id, known.scope, known.subject, now), now)
        details = {"revision": made.id, "withdraws": known.id, "cause": known.cause, "why": why}
        store.audit.write(now, by, "withdraw model", f"{known.scope} {known.subject}", details)
        return made
