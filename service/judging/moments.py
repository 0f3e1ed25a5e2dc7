"""Step: can a session have been measured when its file says?

Clocks that lost their time start somewhere in the past. And was a block measured twice at one moment? One of the two
files is then a copy of the other, or its correction. A file that says no moment of its own has none to share. As found
and as left are two measurements, however they are dated, and so are those of other sensors.
"""

from collections.abc import Collection, Iterator
from datetime import UTC, datetime, timedelta

from estimator.message import say
from service.ingest.checked import Checked
from service.judging.known_unit import KnownUnit
from service.kit.names import day_of
from service.sessions.doubt import Doubt
from service.sessions.records import StoredSession
from service.sessions.store import Sessions

FIRST_CLOCK = datetime(1980, 1, 7, tzinfo=UTC)
"""Clocks that lost their time start in 1970, or in 1980 with GPS; there was no session file then."""
MILLENNIUM, RUNNING = datetime(2000, 1, 1, tzinfo=UTC), timedelta(days=31)
"""Where the clocks of loggers start that lost their time, and how long such a clock runs before somebody sets it."""
LONGEST_LIFE = timedelta(days=3653)
"""Before a unit's first session: of older ones the records are missing, or the date is wrong."""
LOST = "the clock had lost its time; put the date of the measurement into the file"


def of_date(known: KnownUnit, new: Checked, but: Collection[str]) -> Iterator[Doubt]:
    """A doubt for a date before the unit existed; ``but`` are sessions that say nothing of that."""
    at, day = new.measured_at, day_of(new.measured_at)
    if at < FIRST_CLOCK or MILLENNIUM <= at < MILLENNIUM + RUNNING:
        yield Doubt(say("It is dated {day}", day=day), LOST)
        return
    first = next((one.at for one in known.records.counted if one.id not in but), None)
    if first is not None and first - at > LONGEST_LIFE:
        years = (first - at).days // 365
        yield Doubt(say("It is dated {day}, {years} years before the unit's first session", day=day, years=years), LOST)


def of_moment(known: KnownUnit, new: Checked, but: Collection[str]) -> Iterator[Doubt]:
    """A doubt for an accepted session of the same block, programme and moment, other than ``but``."""
    session = new.session
    if session.started_at is None:
        return
    own = (session.block, session.programme, new.measured_at)
    for one in known.records.counted:
        if (one.block, one.programme, one.at) != own or one.id in but:
            continue
        rival = Sessions(known.store).get(one.id)
        if not _are_apart(known, rival, new):
            yield Doubt(
                say(
                    "The session of {filename} was measured at the same moment, {measured_at}",
                    filename=rival.filename,
                    measured_at=_moment(new.measured_at),
                ),
                "this file corrects that one or is a copy of it, or one of both has a wrong time",
                stands_for=rival.id,
            )
            return


def _moment(at: datetime) -> str:
    """``1 May 2026, 09:00:00 UTC``."""
    return say("{day}, {time} UTC", day=day_of(at), time=f"{at:%H:%M:%S}")


def _are_apart(known: KnownUnit, rival: StoredSession, new: Checked) -> bool:
    """Whether both can be, at one moment."""
    if {rival.stage, new.session.stage} == {"as-found", "as-left"}:
        return True
    measured = {sensor.name for sensor in known.calibration(rival.id).sensors}
    return measured.isdisjoint(sensor.name for sensor in new.session.sensors)
