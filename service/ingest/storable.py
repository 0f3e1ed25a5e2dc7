"""Step: what the store needs of a session beyond what a calibration needs."""

from datetime import UTC, datetime, timedelta

from estimator.errors import FormatError, Problem
from estimator.session import CalibrationSession

LONGEST_NAME = 200
LONGEST_NOTES = 20_000
CLOCK_LEEWAY = timedelta(days=1)


def require_storable(session: CalibrationSession, now: datetime, filename: str) -> None:
    """FormatError with every text that cannot be stored and a measuring date that cannot be."""
    problems = [*_text_problems(session), *_date_problems(session, now)]
    if problems:
        raise FormatError(problems, filename)


def measured_at(session: CalibrationSession, now: datetime) -> datetime:
    """When the session was measured, UTC; the upload's time when the file does not say."""
    if session.started_at is None:
        return now
    stated = datetime.fromisoformat(session.started_at)
    return (stated if stated.tzinfo else stated.replace(tzinfo=UTC)).astimezone(UTC)


def plain_filename(filename: str) -> str:
    """The last part of an uploaded name, printable; only ever shown, never used as a path."""
    last = filename.replace("\\", "/").rsplit("/", 1)[-1]
    return "".join(c for c in last if c.isprintable())[:LONGEST_NAME] or "upload"


def _text_problems(session: CalibrationSession) -> list[Problem]:
    names = {
        "unit": session.unit,
        "unit_type": session.unit_type or "",
        "stand.id": session.stand.id if session.stand else "",
    }
    names |= {f"sensors[{i}].name": sensor.name for i, sensor in enumerate(session.sensors)}
    names |= {f"sensors[{i}].reading_unit": sensor.reading_unit for i, sensor in enumerate(session.sensors)}
    texts = {"operator": session.operator, "notes": session.notes}
    limits = [(field, text, LONGEST_NAME) for field, text in names.items()]
    limits += [(field, text, LONGEST_NOTES) for field, text in texts.items()]
    return [Problem(field, fault) for field, text, longest in limits if (fault := _fault(text, longest))]


def _fault(text: str, longest: int) -> str | None:
    if len(text) > longest:
        return f"is {len(text)} characters long; at most {longest} are kept"
    if "\x00" in text or any("\ud800" <= c <= "\udfff" for c in text):
        return "holds characters that are not text (NUL or half of a pair); remove them"
    return None


def _date_problems(session: CalibrationSession, now: datetime) -> list[Problem]:
    try:
        at = measured_at(session, now)
    except (ValueError, OverflowError):
        return [Problem("started_at", "is not a date and time; write it like 2026-03-01T09:00:00Z")]
    if at > now + CLOCK_LEEWAY:
        return [Problem("started_at", f"lies in the future ({at:%Y-%m-%d}); check the date or the clock that wrote it")]
    return []
