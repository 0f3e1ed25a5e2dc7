"""The page of what other tolerances would change, before they are set."""

from collections.abc import Mapping
from dataclasses import dataclass

from service.pages.tolerance_form import Wanted
from service.records.tolerance_preview import TolerancePreview
from service.records.unit import UnitType
from service.words.conditions import Condition, condition_of
from service.words.tolerance_preview import headline_of, notes_of

CARRIED_APART = ("by", "why", "csrf")
"""Fields that the page's own form asks for."""


@dataclass(frozen=True)
class ChangeRow:
    """One unit with another verdict."""

    unit: str
    before: Condition
    after: Condition
    reason: str


@dataclass(frozen=True)
class PreviewPage:
    """Everything the page shows."""

    name: str
    headline: str
    rows: tuple[ChangeRow, ...]
    notes: tuple[str, ...]
    interval: str
    """That the form asks for, where it is another one; empty where it stays."""
    carried: tuple[tuple[str, str], ...]
    """Numbers as they were written, to be set as they are."""
    why: str


def preview_page(known: UnitType, asked: Wanted, form: Mapping[str, str], found: TolerancePreview) -> PreviewPage:
    """What would change, and the form that sets it."""
    other = asked.interval_days != known.maximum_interval_days
    return PreviewPage(
        name=known.name,
        headline=headline_of(found),
        rows=tuple(
            ChangeRow(one.unit, condition_of(one.before), condition_of(one.after), one.reason) for one in found.changes
        ),
        notes=tuple(notes_of(found)),
        interval=f"{asked.interval_days:.12g}" if other else "",
        carried=tuple((key, value) for key, value in form.items() if key not in CARRIED_APART),
        why=form.get("why", ""),
    )
