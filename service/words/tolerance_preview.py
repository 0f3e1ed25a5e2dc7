"""What other tolerances would change, in words."""

from collections.abc import Iterator

from estimator.wording import counted
from service.records.tolerance_preview import TolerancePreview


def headline_of(found: TolerancePreview) -> str:
    """``With these, 3 of 40 units change``: of those that were judged by them."""
    changed = len(found.changes)
    if not found.judged:
        return "No unit of this type has a session that tolerances decide"
    if not changed:
        return "With these, no unit changes"
    return f"With these, {changed} of {found.judged} units {'changes' if changed == 1 else 'change'}"


def notes_of(found: TolerancePreview) -> Iterator[str]:
    """What was not looked at, and why."""
    if found.references:
        yield f"{counted(found.references, 'unit')} not counted: the latest session is a reference, judged by nothing."
    if found.recordings:
        units = counted(found.recordings, "unit")
        yield f"{units} not counted: the latest session is a recording in service without a calibration beside it."
    if found.beyond:
        yield f"{counted(found.beyond, 'unit')} not looked at: only the worst ones are."
