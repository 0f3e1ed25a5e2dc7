"""Views of lists that people keep under a name."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from service.api.schemas.fields import Name
from service.records.saved_view import ListPage, SavedView

ViewName = Annotated[str, StringConstraints(pattern=r"^[^\x00]*\S[^\x00]*$", max_length=100)]
ViewQuery = Annotated[str, StringConstraints(pattern=r"^[^\x00?#\s]*$", max_length=20_000)]


class NewViewSchema(BaseModel):
    """A view to keep."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={
            "example": {"page": "fleet", "name": "overdue on ODG-1", "query": "due=overdue&stand=ODG-1", "by": "K. Ito"}
        },
    )

    page: ListPage = Field(description="Of which list.")
    name: ViewName = Field(description="Its name.")
    query: ViewQuery = Field(description="What stands behind the `?` of the list's address.")
    shared: bool = Field(default=False, description="For everybody; where nobody signs in, every view is.")
    by: Name = Field(description="Who keeps it.")


class ViewList(BaseModel):
    """Views of lists."""

    views: tuple[SavedView, ...] = Field(description="The views, by list and name.")
