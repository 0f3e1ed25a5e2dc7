"""Step: uploaded bytes → a session that can be calibrated and stored; every fault is named with its place."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from functools import cached_property
from pathlib import Path

from estimator.errors import FormatError, Problem, problem_at
from estimator.message import say
from estimator.moments import local_moment, written
from estimator.session import CalibrationSession
from service.ingest import read_upload
from service.ingest.digest import readings_digest
from service.ingest.names import LONGEST_NAME, fault_of_name, fault_of_serial, plain_name
from service.kit.text import fault_of_text, with_plain_ends

LONGEST_NOTES = 20_000
"""Characters of notes and operator: some pages, so that no upload fills the database."""
CLOCK_LEEWAY = timedelta(days=1)
"""Largest lead of a date over the clock: a stand in another time zone is up to a day ahead."""


@dataclass(frozen=True, eq=False)
class Checked:
    """A session as the later steps need it: what the file says, and what follows from it for the store."""

    session: CalibrationSession
    measured_at: datetime
    """Start of the measurement with the offset in the file; the upload's time, UTC, where the file has none."""
    type_name: str
    """Name of the unit's type for its first session: from the file, or a description."""
    stand: str | None
    """Stand of the measurement; None without one."""

    @cached_property
    def readings_digest(self) -> str:
        """Digest of the readings alone."""
        return readings_digest(self.session)


def check(
    content: bytes | Path, filename: str, now: datetime, is_known: Callable[[str], bool] = lambda _: False
) -> Checked:
    """The session in uploaded bytes; SessionError with every problem of an unusable file.

    ``is_known``: whether a unit of this serial number exists: one stored by an earlier version keeps a number that is
    no longer accepted.
    """
    session = read_upload(content, filename)
    serial = plain_name(session.unit)
    fault = fault_of_serial(serial)
    if (fault is not None or serial != session.unit) and is_known(session.unit):
        serial, fault = session.unit, None
    serial_problems = [] if fault is None else [Problem("unit", fault)]
    problems = [*serial_problems, *_text_problems(session), *_date_problems(session, now)]
    if problems:
        raise FormatError(problems, filename)
    return as_checked(session, now, serial)


def as_checked(session: CalibrationSession, uploaded_at: datetime, serial: str) -> Checked:
    """A session that was checked before, as one read from the store, with its unit's serial number."""
    session = session if session.unit == serial else replace(session, unit=serial)
    return Checked(
        session=session,
        measured_at=_measured_at(session, uploaded_at),
        type_name=session.unit_type or _described(session),
        stand=None if session.stand is None else session.stand.id,
    )


def dated(session: CalibrationSession, at: datetime) -> CalibrationSession:
    """A stored session with the date it is stored under: from its file, or when it was received."""
    return replace(session, started_at=written(at))


def plain_filename(filename: str) -> str:
    """The last part of an uploaded name, printable; only ever shown, never used as a path."""
    last = filename.replace("\\", "/").rsplit("/", 1)[-1]
    return "".join(c for c in last if c.isprintable())[:LONGEST_NAME] or "upload"


def _measured_at(session: CalibrationSession, now: datetime) -> datetime:
    return now if session.started_at is None else local_moment(session.started_at)


def _described(session: CalibrationSession) -> str:
    """``accelerometer × 6, V``; of several kinds each with its number."""
    units = sorted({sensor.reading_unit for sensor in session.sensors})
    kinds = sorted(Counter(sensor.kind for sensor in session.sensors).items())
    return f"{', '.join(f'{kind} × {number}' for kind, number in kinds)}, {' and '.join(units)}"[:LONGEST_NAME]


def _text_problems(session: CalibrationSession) -> list[Problem]:
    names = {"unit_type": session.unit_type or "", "stand.id": session.stand.id if session.stand else ""}
    names |= {f"sensors[{i}].name": sensor.name for i, sensor in enumerate(session.sensors)}
    names |= {f"sensors[{i}].reading_unit": sensor.reading_unit for i, sensor in enumerate(session.sensors)}
    texts = {"operator": session.operator, "notes": session.notes}
    faults = [(field, fault_of_name(text)) for field, text in names.items()]
    faults += [(field, _fault(text)) for field, text in texts.items()]
    return [Problem(field, fault) for field, fault in faults if fault]


def _fault(text: str) -> str | None:
    if len(text) > LONGEST_NOTES:
        parts = {"length": len(text), "longest_notes": LONGEST_NOTES}
        return say("is {length} characters long; at most {longest_notes} are kept", **parts)
    return fault_of_text(with_plain_ends(text))


def _date_problems(session: CalibrationSession, now: datetime) -> list[Problem]:
    try:
        measured_at = _measured_at(session, now)
    except (ValueError, OverflowError):
        return [Problem("started_at", "is not a date and time; write it like 2026-03-01T09:00:00Z")]
    if measured_at > now + CLOCK_LEEWAY:
        return [
            problem_at(
                "started_at",
                "is in the future ({date}); check the date or the clock of the recorder",
                date=f"{measured_at:%Y-%m-%d}",
            )
        ]
    return []
