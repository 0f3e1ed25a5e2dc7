"""Labels to stick on units."""

from typing import Annotated, Literal

from fastapi import APIRouter, Query, Request, Response

from service.api.exports import as_file
from service.api.schemas.fields import Serial
from service.api.schemas.problem import errors
from service.dependencies import Now, Reading, SettingsOf
from service.errors import NotFoundError
from service.reports.label import label_of, label_pdf, label_svg

router = APIRouter(prefix="/units", tags=["handing on"])
PDF, SVG = "application/pdf", "image/svg+xml"
"""Media types of the two forms."""
BYTES = {"schema": {"type": "string", "format": "binary"}}
"""How OpenAPI describes a file."""


@router.get(
    "/{serial:path}/label.{format}",
    responses={200: {"content": {PDF: BYTES, SVG: BYTES}}, **errors(404, 422)},
    response_class=Response,
)
def read_label(
    request: Request,
    serial: Serial,
    format: Literal["svg", "pdf"],
    store: Reading,
    settings: SettingsOf,
    now: Now,
    *,
    due: Annotated[bool, Query(description="Whether it says when the calibration is due.")] = True,
) -> Response:
    """A small label: serial number, due date, and a QR code that opens the unit's page.

    Its address is that of the setting `IMU_HEALTH_PUBLIC_URL`, or the one that this request was sent to.
    """
    unit = store.fleet.unit(serial)
    if unit is None:
        raise NotFoundError(f"There is no unit {serial!r}.")
    label = label_of(unit, settings.public_url or str(request.base_url), now, with_due=due)
    if format == "svg":
        return as_file(label_svg(label), SVG, f"{serial}-label.svg")
    return as_file(label_pdf(label, now), PDF, f"{serial}-label.pdf")
