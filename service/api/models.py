"""Model revisions: the causes that engineers accepted."""

from typing import Annotated

from fastapi import APIRouter, Query

from service.admission import PersonOf
from service.api.schemas.fields import Number, Text, WindowOf
from service.api.schemas.flags import Handling
from service.api.schemas.models import ModelPage, ModelSchema
from service.api.schemas.problem import errors
from service.dependencies import Now, Reading, StorageOf
from service.flows.withdraw_model import withdraw_model
from service.records.model import Scope
from service.storage.queries.models import ModelQuery

router = APIRouter(prefix="/models", tags=["models"])


@router.post("/{id}/withdraw", status_code=201, responses=errors(400, 404, 409, 422))
def withdraw_cause(id: Number, handling: Handling, storage: StorageOf, now: Now, person: PersonOf) -> ModelSchema:
    """Take an accepted cause out of the model: a revision of its own; sessions from now on are calibrated without."""
    return ModelSchema.model_validate(withdraw_model(storage, id, person.signs(handling.by), handling.why, now))


@router.get("", responses=errors(422))
def list_models(
    store: Reading,
    window: WindowOf,
    scope: Annotated[Scope | None, Query(description="Only models of units, of unit types or of stands.")] = None,
    subject: Annotated[Text | None, Query(description="Only of this unit, unit type or stand.")] = None,
) -> ModelPage:
    """Accepted causes, newest first."""
    found = store.models.page(ModelQuery(scope, subject, window.offset, window.limit))
    listed = [ModelSchema.model_validate(revision) for revision in found]
    return ModelPage(models=listed, page=window.page, limit=window.limit, next_page=window.next_after(len(listed)))
