"""The label of a unit: serial number, when its calibration is due, and a QR code that opens its page."""

from dataclasses import dataclass
from datetime import datetime
from urllib.parse import quote

import segno

from estimator.message import say
from service.fleet.condition import UnitSummary
from service.kit.measures import HARD, day_of
from service.languages.language import Language
from service.papers.typeset import typeset, typeset_svg

TEMPLATE = "label.typ"
QUIET = 4
"""Modules of white that a QR code needs around it (ISO/IEC 18004)."""


@dataclass(frozen=True)
class Label:
    """Everything that the label shows."""

    serial: str
    unit_type: str
    due: str
    """Empty where it was not wanted."""
    why: str
    """The rule that set the date; empty where the label states none."""
    stated: str
    """The day on which it was printed: the due date is that of this day."""
    address: str
    """Of the unit's page."""
    code: str
    """The address as a QR code, SVG."""
    simulated: bool


def label_of(unit: UnitSummary, base: str, now: datetime, *, with_due: bool) -> Label:
    """The label of a unit; ``base`` is the address under which people reach the pages."""
    address = f"{base.rstrip('/')}/units/{quote(unit.serial)}"
    return Label(
        serial=unit.serial,
        unit_type=unit.unit_type,
        due=_due(unit.due, now) if with_due else "",
        why=unit.due_reason if with_due and unit.due is not None else "",
        stated=day_of(now),
        address=address,
        code=segno.make_qr(address, error="l").svg_inline(border=QUIET, omitsize=True),
        simulated=unit.simulated,
    )


def _due(due: datetime | None, now: datetime) -> str:
    if due is None:
        return "Calibration due: not known"
    return (
        say("Calibration overdue since {date}", date=_held(due))
        if due < now
        else say("Calibration due {date}", date=_held(due))
    )


def _held(day: datetime) -> str:
    """The day on one line."""
    return say(
        "{day}{nbsp}{month}{nbsp}{year}",
        day=day.day,
        month=f"{day:%b}",
        year=day.year,
        nbsp=HARD,
    )


def label_pdf(label: Label, now: datetime, language: Language = Language.ENGLISH) -> bytes:
    """60 mm by 30 mm, for a label printer."""
    return typeset(TEMPLATE, label, now, language)


def label_svg(label: Label, language: Language = Language.ENGLISH) -> bytes:
    """The same as a drawing; letters are outlines, so that it needs no fonts."""
    return typeset_svg(TEMPLATE, label, language)
