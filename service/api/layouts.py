"""Tables of people's own layout: how one is understood, before anything is stored."""

from typing import Annotated

from fastapi import APIRouter, Query

from service.api.received import REQUEST_BODY, FileOf
from service.api.schemas.fields import Text
from service.api.schemas.layouts import LayoutColumn, PreviewSchema
from service.api.schemas.problem import errors, faults
from service.dependencies import StorageOf
from service.records.received import held
from service.views.layout_preview import felt_length, first_rows, preview

router = APIRouter(prefix="/layouts", tags=["sessions"])
Unit = Annotated[Text, Query(description="Whose last session says what the file does not.")]
UnitType = Annotated[Text, Query(description="The last session of this stored type says it.")]


@router.post("/preview", responses=errors(400, 413, 422), openapi_extra=REQUEST_BODY)
def preview_layout(file: FileOf, storage: StorageOf, unit: Unit = "", unit_type: UnitType = "") -> PreviewSchema:
    """How a table of one's own layout is understood, or with `mapping` would be read. Nothing is stored."""
    found = preview(
        storage, held(file.content), file.filename, mapping=file.mapping, unit=unit.strip(), unit_type=unit_type.strip()
    )
    seen, session = found.seen, found.session
    return PreviewSchema(
        mapping=found.mapping,
        remembered=found.remembered,
        fingerprint=found.fingerprint,
        rows=seen["rows"],
        sheets=list(seen["sheets"]),
        columns=[LayoutColumn.model_validate(column) for column in seen["columns"]],
        problems=faults(found.problems),
        first_rows=[] if session is None else first_rows(session),
        felt=None if session is None else felt_length(session),
    )
