"""A session file to fill in, made for a unit or a type of units."""

from typing import Annotated, Literal

from fastapi import APIRouter, Query, Request, Response

from service.api.exports import BINARY, as_file
from service.api.fleet import XLSX
from service.api.schemas.fields import Text
from service.api.schemas.problem import errors
from service.dependencies import Now, StorageOf
from service.languages.language import asked
from service.planning.question import PlanQuestion
from service.reports.session_template import session_template
from service.views.pattern import pattern

router = APIRouter(tags=["sessions"])
Unit = Annotated[Text, Query(description="Made like the last session of this serial number, where it has one.")]
UnitType = Annotated[Text, Query(description="Made for this stored type, like the last session of its units.")]
Kind = Annotated[Literal["accelerometer", "gyroscope"], Query(description="Without a unit and a type: of the sensors.")]
Sensors = Annotated[int, Query(ge=3, le=12, description="Without a unit and a type: how many.")]


@router.get(
    "/session-template", responses={200: {"content": {XLSX: BINARY}}, **errors(404, 422)}, response_class=Response
)
def read_template(
    request: Request,
    storage: StorageOf,
    now: Now,
    *,
    unit: Unit = "",
    unit_type: UnitType = "",
    kind: Kind = "accelerometer",
    sensors: Sensors = 6,
) -> Response:
    """A workbook to fill in and upload as it is: sensors, stand and schedule are there, with units and choices. In the
    language of `?lang=`, or of Accept-Language."""
    block = PlanQuestion.model_validate({"kind": kind, "sensors": sensors})
    like = pattern(storage, unit.strip(), unit_type.strip(), block)
    name = unit.strip() or unit_type.strip() or f"{sensors}-{kind}s"
    language = asked(request.scope)
    made = as_file(session_template(like, now, language), XLSX, f"session-{name}.xlsx")
    made.headers["Content-Language"] = language.value
    return made
