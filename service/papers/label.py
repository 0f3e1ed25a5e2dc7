"""The label of a unit: serial number, may it be used, next calibration, and a QR code that opens its page."""

from dataclasses import dataclass
from datetime import datetime
from urllib.parse import quote

import segno

from estimator.message import capitalised, say
from service.fleet.condition import UnitSummary
from service.fleet.use import Use, in_words
from service.judging.records import Usable
from service.judging.usable_words import ASK_AGAIN
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
    use: str
    """Restriction of use, shown before anything else; empty where the unit is plainly usable, or the state was not
    wanted.
    """
    is_usable: bool
    due: str
    """Due date; empty where it was not wanted, or where something else must be done first."""
    why: str
    """The rule that set the date, the action, or the reason against the use; empty where the label states none."""
    stated: str
    """The day on which it was printed: everything else is that of this day."""
    address: str
    """Address of the unit's page."""
    code: str
    """The address as a QR code, SVG."""
    simulated: bool


def label_of(unit: UnitSummary, use: Usable, base: str, *, with_due: bool) -> Label:
    """The label of a unit; ``base`` is the address under which people reach the pages. Without a date it says nothing
    that changes."""
    address = f"{base.rstrip('/')}/units/{quote(unit.serial)}"
    return Label(
        serial=unit.serial,
        unit_type=unit.unit_type,
        use=("" if use.answer is Use.YES else in_words(use.answer, "")) if with_due else "",
        is_usable=use.usable,
        due=_due(use) if with_due else "",
        why=_why(use) if with_due else "",
        stated=day_of(use.as_of),
        address=address,
        code=segno.make_qr(address, error="l").svg_inline(border=QUIET, omitsize=True),
        simulated=unit.simulated,
    )


def _due(use: Usable) -> str:
    if use.due is None:
        return ""
    if use.is_overdue:
        return say("Calibration overdue since {date}", date=_held(use.due))
    return say("Calibration due {date}", date=_held(use.due))


def _why(use: Usable) -> str:
    if use.answer is Use.RESERVED and use.action not in ("", ASK_AGAIN):
        return say("{action}.", action=capitalised(use.action))
    if use.usable:
        return use.due_reason
    return "" if use.due is not None and len(use.reasons) == 1 else use.why


def _held(day: datetime) -> str:
    """The day on one line."""
    parts = {"day": day.day, "month": f"{day:%b}", "year": day.year, "nbsp": HARD}
    return say("{day}{nbsp}{month}{nbsp}{year}", **parts)


def label_pdf(label: Label, now: datetime, language: Language = Language.ENGLISH) -> bytes:
    """60 mm by 30 mm, for a label printer."""
    return typeset(TEMPLATE, label, now, language)


def label_svg(label: Label, language: Language = Language.ENGLISH) -> bytes:
    """The label as a drawing; letters are outlines, so that it needs no fonts."""
    return typeset_svg(TEMPLATE, label, language)
