"""Labels to stick on units."""

from dataclasses import dataclass
from datetime import datetime
from typing import Annotated

from fastapi import APIRouter, Depends, Query, Request, Response

from service.api.exports import as_file
from service.api.schemas.fields import Serial
from service.api.schemas.problem import errors
from service.dependencies import LanguageOf, Now, Reading, SettingsOf
from service.errors import NotFoundError
from service.reports.label import Label, label_of, label_pdf, label_svg
from service.settings import Settings
from service.storage.store import Store

router = APIRouter(prefix="/units", tags=["handing on"])
PDF, SVG = "application/pdf", "image/svg+xml"
"""Media types of the two forms."""
BYTES = {"schema": {"type": "string", "format": "binary"}}
"""How OpenAPI describes a file."""


Due = Annotated[bool, Query(description="Whether it says when the calibration is due.")]


@dataclass(frozen=True)
class Labels:
    """Makes labels as this request wants them."""

    request: Request
    store: Store
    settings: Settings
    now: datetime

    def of(self, serial: str, *, due: bool) -> Label:
        """The label of a unit; its address is the public one, or the one that the request was sent to."""
        unit = self.store.fleet.unit(serial)
        if unit is None:
            raise NotFoundError(f"There is no unit {serial!r}.")
        base = self.settings.public_url or str(self.request.base_url)
        return label_of(unit, base, self.now, with_due=due)


def _labels(request: Request, store: Reading, settings: SettingsOf, now: Now) -> Labels:
    return Labels(request, store, settings, now)


LabelsOf = Annotated[Labels, Depends(_labels)]


@router.get(
    "/{serial:path}/label.pdf",
    responses={200: {"content": {PDF: BYTES}}, **errors(404, 422)},
    response_class=Response,
)
def read_label(serial: Serial, labels: LabelsOf, language: LanguageOf, *, due: Due = True) -> Response:
    """A small label: serial number, due date, and a QR code that opens the unit's page.

    Its address is that of the setting `IMU_HEALTH_PUBLIC_URL`, or the one that this request was sent to.
    """
    return as_file(label_pdf(labels.of(serial, due=due), labels.now, language), PDF, f"{serial}-label.pdf")


@router.get(
    "/{serial:path}/label.svg",
    responses={200: {"content": {SVG: BYTES}}, **errors(404, 422)},
    response_class=Response,
)
def draw_label(serial: Serial, labels: LabelsOf, language: LanguageOf, *, due: Due = True) -> Response:
    """The same label as a drawing."""
    return as_file(label_svg(labels.of(serial, due=due), language), SVG, f"{serial}-label.svg")
