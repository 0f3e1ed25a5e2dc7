"""Column types and indexes with the same meaning on SQLite and PostgreSQL."""

import json
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import BigInteger, ColumnElement, DateTime, Dialect, Integer, String, Text, text, type_coerce
from sqlalchemy.orm import InstrumentedAttribute
from sqlalchemy.types import TypeDecorator

from estimator.message import PLACE, Message, as_document, say, with_messages

RESOLVED = "resolved"
"""State of a closed flag."""
IS_OPEN, IS_WAITING, IS_QUESTIONED = "state <> 'resolved'", "state = 'waiting'", "state = 'questioned'"
IS_AT_WORK = "ended_at IS NULL"
IS_FAILED = "state = 'failed'"
"""Rows of flags, of deliveries, of sessions, of jobs and of diagnoses that are queried all the time: few of many, so
each has an index of its own."""
PARTS = "\x1f"
"""Separator between the English of a stored message and its parts; not in text written by people."""
BYTES = BigInteger().with_variant(Integer(), "sqlite")
"""Size of a file, which may exceed 2 GiB. SQLite's integers have 64 bits anyway."""


def only_where(condition: str) -> dict[str, Any]:
    """An index of those rows only, on both engines."""
    return {"sqlite_where": text(condition), "postgresql_where": text(condition)}


class UtcDateTime(TypeDecorator[datetime]):
    """An aware time, stored and returned in UTC on every engine."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Converts a time to UTC; a naive time is a mistake of the caller."""
        if value is None:
            return None
        if value.tzinfo is None:
            raise ValueError("a time without a zone cannot be stored")
        utc = value.astimezone(UTC)
        return utc.replace(tzinfo=None) if dialect.name == "sqlite" else utc

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Always aware, always UTC."""
        if value is None:
            return None
        return value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)


class Sentence(TypeDecorator[str]):
    """A text that may be a message: its English, and after a separator its parts as JSON; any other text is stored
    unchanged. Other readers of the database find the English first, and the views have nothing else."""

    impl = String
    cache_ok = True

    def process_bind_param(self, value: str | None, dialect: Dialect) -> str | None:
        """A text with the separator is stored as the only part of a message; an empty message is an empty text."""
        if not value or not (isinstance(value, Message) or PARTS in value):
            return None if value is None else str.__str__(value)
        message = value if isinstance(value, Message) else say("{text}", text=value)
        return message.replace(PARTS, " ") + PARTS + _line(as_document(message))

    def process_result_value(self, value: str | None, dialect: Dialect) -> str | None:
        """The message with its parts; what an earlier release stored is a plain text."""
        _, has_parts, parts = (value or "").partition(PARTS)
        if not has_parts:
            return value
        message: str = with_messages(json.loads(parts))
        return message


class LongSentence(Sentence):
    """A message with its parts, declared as TEXT."""

    impl = Text
    cache_ok = True


def is_made_of(sentence: ColumnElement[str] | InstrumentedAttribute[str], template: str) -> ColumnElement[bool]:
    """Whether a stored sentence is of a template, which an earlier release stored as a plain text."""
    stored = type_coerce(sentence, String)
    as_message = PARTS + _line({"message": template}).removesuffix("}")
    return stored.contains(as_message, autoescape=True) | stored.startswith(PLACE.split(template)[0], autoescape=True)


def _line(document: Any) -> str:
    return json.dumps(document, ensure_ascii=False, separators=(",", ":"))
