"""Step: whether a unit is overdue follows from its outlook and the clock alone, whatever changed the outlook."""

from dataclasses import replace
from datetime import datetime

from service.flags.records import Concern, Flag, Matter
from service.flags.store import Flags
from service.outlook.records import UnitOutlook
from service.outlook.words.due import NOTHING_DUE, calibrated, was_due
from service.records.flagging.settle import Occasion, resolve_as_done, see_again
from service.sessions.records import StoredSession
from service.storage.store import Store


def no_longer_overdue(
    store: Store, occasion: Occasion, outlook: UnitOutlook | None, latest: StoredSession | None = None
) -> tuple[Flag, ...]:
    """The one matter that resolves itself: nothing is due, or not yet. What is open still is returned, and says what is
    due now.

    ``latest``: the unit's latest calibration, the reason where it came after the flag was raised.
    It is raised by the clock (`overdue_units`) and not here: records that are entered late, one after another, would
    raise and resolve it with every one.
    """
    opened = tuple(flag for flag in Flags(store).open_of(occasion.unit) if flag.matter is Matter.OVERDUE)
    concern = overdue_by(outlook, occasion.at)
    if concern is not None:
        for flag in opened:
            if flag.summary != concern.summary:
                see_again(store, replace(occasion, session=flag.session), flag, concern)
        return opened
    for flag in opened:
        why = NOTHING_DUE if latest is None or latest.uploaded_at < flag.raised_at else calibrated(latest)
        resolve_as_done(store, occasion, flag, why)
    return ()


def overdue_by(outlook: UnitOutlook | None, now: datetime) -> Concern | None:
    """What is said of a unit whose date has passed; None of any other."""
    if outlook is None or outlook.due is None or outlook.due >= now:
        return None
    return Concern(Matter.OVERDUE, "", 1, was_due(outlook.due, outlook.reason))
