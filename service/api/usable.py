"""The one question of a ground computer: may this unit be used?"""

from hashlib import sha256
from typing import Annotated, Any

from fastapi import APIRouter, Header, Request, Response

from service.api.schemas.fields import Serial
from service.api.schemas.problem import errors
from service.api.schemas.usable import UsableSchema
from service.dependencies import Now, ReaderOf, Reading
from service.records.usable import Usable
from service.views.usable import usable

router = APIRouter(prefix="/units", tags=["units"])
NOT_MODIFIED = 304
HELD: dict[int | str, dict[str, Any]] = {
    NOT_MODIFIED: {"description": "The answer that the caller holds is still true, but for `as_of`."}
}


@router.get("/{serial:path}/usable", responses={**HELD, **errors(404, 422)}, response_model=UsableSchema)
def read_usable(
    request: Request,
    serial: Serial,
    store: Reading,
    now: Now,
    reader: ReaderOf,
    if_none_match: Annotated[str | None, Header(description="The `ETag` of an answer that is held.")] = None,
) -> Response:
    """Whether the unit may be used now, why, and until when; 200 for yes and for no. In doubt the answer is no."""
    reader.until_dated(serial)
    answer = _schema(request, usable(store, serial, now))
    tag = f'"{sha256(answer.model_dump_json(exclude={"as_of"}).encode()).hexdigest()[:32]}"'
    headers = {"ETag": tag, "Cache-Control": "no-cache"}
    if if_none_match is not None and tag in if_none_match:
        return Response(status_code=NOT_MODIFIED, headers=headers)
    return Response(answer.model_dump_json(), media_type="application/json", headers=headers)


def _schema(request: Request, found: Usable) -> UsableSchema:
    due, correction = found.until, found.correction
    link = None if correction is None else request.url_for("read_correction", id=correction).path
    return UsableSchema(
        **{**vars(found), "correction": link},
        reservation=" ".join(found.reservations),
        next_calibration=None if due is None else due.date(),
    )
