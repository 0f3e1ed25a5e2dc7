"""Flow: accepted causes, newest first."""

from service.records.model import ModelRevision, Scope
from service.storage.queries.models import ModelQuery
from service.storage.store import Store


def model_revisions(
    store: Store, *, scope: Scope | None = None, subject: str | None = None, page: int = 1, limit: int = 100
) -> tuple[ModelRevision, ...]:
    """One page of the revisions of all models, or of those of one scope or subject."""
    return store.models.page(ModelQuery(scope, subject, (page - 1) * limit, limit))
