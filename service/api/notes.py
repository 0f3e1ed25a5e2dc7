"""Notes on units' histories."""

from fastapi import APIRouter

from service.admission import PersonOf
from service.api.schemas.fields import Number
from service.api.schemas.flags import Handling
from service.api.schemas.problem import errors
from service.dependencies import Now, StorageOf
from service.flows.withdraw_note import withdraw_note
from service.records.event import Note

router = APIRouter(prefix="/notes", tags=["units"])


@router.post("/{id}/withdraw", responses=errors(400, 404, 409, 422))
def withdraw(id: Number, handling: Handling, storage: StorageOf, now: Now, person: PersonOf) -> Note:
    """Say that a note no longer holds, and why. It stays on record."""
    return withdraw_note(storage, id, person.signs(handling.by), handling.why, now)
