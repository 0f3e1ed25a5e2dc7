"""May a unit be used? Over HTTP."""

from dataclasses import dataclass
from hashlib import sha256
from typing import Annotated

from fastapi import APIRouter, Header, Request, Response
from pydantic import TypeAdapter

from estimator.json_object import Json
from service.judging.records import Usable
from service.judging.usable_reading import usable_unit
from service.kit.answer import answer
from service.languages.catalogue import said_in
from service.languages.language import asked
from service.web.dependencies import Now, Reading
from service.web.fields import Serial
from service.web.problem_document import errors
from service.work.dependencies import ReaderOf


@answer
@dataclass(frozen=True)
class UsableAnswer(Usable):
    """The one question of a ground computer, answered."""

    correction: str | None
    """Address of the correction that firmware applies."""


router = APIRouter(prefix="/units", tags=["units"])
NOT_MODIFIED = 304
JSON = TypeAdapter(UsableAnswer)
HELD: dict[int | str, Json] = {
    NOT_MODIFIED: {"description": "The answer that the caller holds is still true, but for `as_of`."}
}


@router.get("/{serial:path}/usable", responses={**HELD, **errors(404, 422)}, response_model=UsableAnswer)
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
    answer = _answer(request, said_in(usable_unit(store, serial, now), asked(request.scope)))
    tag = f'"{sha256(JSON.dump_json(answer, exclude={"as_of"})).hexdigest()[:32]}"'
    headers = {"ETag": tag, "Cache-Control": "no-cache", "Vary": "Accept-Language"}
    if if_none_match is not None and tag in if_none_match:
        return Response(status_code=NOT_MODIFIED, headers=headers)
    return Response(JSON.dump_json(answer), media_type="application/json", headers=headers)


def _answer(request: Request, found: Usable) -> UsableAnswer:
    """With the address of the correction."""
    link = None if found.correction is None else request.url_for("read_correction", id=found.correction).path
    return UsableAnswer(**{**vars(found), "correction": link})
