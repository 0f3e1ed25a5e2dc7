"""Model revisions: the causes that engineers accepted."""

from typing import Annotated

from fastapi import APIRouter, Query

from service.admission import PersonOf
from service.api.schemas.fields import Number, Text, WindowOf
from service.api.schemas.flags import Handling
from service.api.schemas.models import ModelAndRecomputations, ModelDocument, ModelPage, model_document, moved_by
from service.api.schemas.problem import errors
from service.dependencies import Now, Reading, ReceptionOf
from service.flows.recompute import recompute_beside
from service.flows.withdraw_model import withdraw_model
from service.records.model import Scope
from service.storage.queries.models import ModelQuery

router = APIRouter(prefix="/models", tags=["models"])


@router.post("/{id}/withdraw", status_code=201, responses=errors(400, 404, 409, 422))
def withdraw_cause(id: Number, handling: Handling, reception: ReceptionOf, now: Now, person: PersonOf) -> ModelDocument:
    """Take an accepted cause out of the model: a revision of its own; sessions from now on are calibrated without.
    What a group of sessions showed goes out of the stored ones too."""
    made = withdraw_model(reception.storage, id, person.signs(handling.by), handling.why, now)
    recompute_beside(reception, now)
    return model_document(made)


@router.get("/{id}", responses=errors(404, 422))
def read_model(id: Number, store: Reading) -> ModelAndRecomputations:
    """One revision, with what it moved in the sessions that it concerns."""
    return moved_by(store.models.get(id), store.recomputations.of(id))


@router.get("", responses=errors(422))
def list_models(
    store: Reading,
    window: WindowOf,
    scope: Annotated[Scope | None, Query(description="Only models of units, of unit types or of stands.")] = None,
    subject: Annotated[Text | None, Query(description="Only of this unit, unit type or stand.")] = None,
) -> ModelPage:
    """Accepted causes, newest first."""
    found = store.models.page(ModelQuery(scope, subject, window.offset, window.limit))
    return ModelPage(models=list(map(model_document, found)), **window.place(len(found)))
