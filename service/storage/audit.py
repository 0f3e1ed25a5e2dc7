"""The audit trail: a chain of hashes, so that a changed, removed or inserted line is detected.

h_i = SHA-256 of the JSON of [h_(i−1), at, who, account, action, subject, details], with h_0 of zeros. Lines are chained
just before their transaction commits, one transaction after the other.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from hashlib import sha256
from typing import Any

from sqlalchemy import String, select, text
from sqlalchemy.orm import Mapped, mapped_column

from estimator.json_object import Json
from service.kit.answer import answer
from service.storage.queries import Queries, Store
from service.storage.tables import Base

ACCOUNT = String(300).with_variant(String(260), "sqlite")
"""A login, and the label of a token in words: 268 characters at most. SQLite holds no text to its length."""


class AuditRow(Base):
    """Action of a person or the service, with a hash of the line and the previous one; the database refuses changes."""

    __tablename__ = "audit"
    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime] = mapped_column(index=True)
    who: Mapped[str]
    account: Mapped[str] = mapped_column(ACCOUNT, server_default="")
    action: Mapped[str] = mapped_column(String(40))
    subject: Mapped[str]
    details: Mapped[Json]
    hash: Mapped[str] = mapped_column(String(64), server_default="")


FIRST = "0" * 64
"""Hash before the first line."""
LOCK = 0x696D_7568
"""Number of PostgreSQL's advisory lock under which lines are chained."""
WRITTEN = "audit"
"""Key of the transaction's unsealed lines in the session's ``info``."""


@answer
@dataclass(frozen=True)
class AuditLine:
    """One action in the audit trail."""

    id: int
    """Number of the line."""
    at: datetime
    """Time of the action, UTC."""
    who: str
    """Person as stated in the request, or by the name of the account."""
    account: str
    """Account that was signed in, with the token that acted for it."""
    action: str
    """Action."""
    subject: str
    """Subject of the action: a session, a unit, a type, a stand, an account."""
    details: Json
    """State before and after, and the reason, as far as the action has them."""
    hash: str
    """SHA-256 of this line and of the one before it."""


@answer
@dataclass(frozen=True)
class AuditCheck:
    """Whether the trail is as it was written."""

    lines: int
    """Number of lines."""
    last: str
    """Hash of the last line; kept elsewhere, it shows later that none was cut off."""
    broken: int | None
    """First line that does not follow from the ones before it; null: none."""
    expected: bool | None = None
    """Whether a hash that was noted before is still there; null: none was given."""


class Audit(Queries):
    """The audit trail: actions of people and the service."""

    def __init__(self, store: Store) -> None:
        super().__init__(store)
        self._account = store.account

    def write(self, at: datetime, who: str, action: str, subject: str, details: Json) -> None:
        """Records an action; never changed afterwards."""
        row = AuditRow(at=at.astimezone(UTC), who=who, action=action, subject=subject, details=details)
        row.account = self._account
        self._session.info.setdefault(WRITTEN, []).append(row)

    def seal(self) -> None:
        """Chains the lines of this transaction, as its last step."""
        lines: list[AuditRow] = self._session.info.pop(WRITTEN, [])
        if not lines:
            return
        self._session.flush()
        if self._session.get_bind().dialect.name == "postgresql":  # SQLite has one writer anyway
            self._session.execute(text("SELECT pg_advisory_xact_lock(:number)"), {"number": LOCK})
        last = self.last()
        for row in lines:
            row.hash = last = _hash(last, row)
        names = ("at", "who", "account", "action", "subject", "details", "hash")
        self.insert_many(AuditRow, [{name: getattr(row, name) for name in names} for row in lines])

    def page(self, limit: int, before: int | None = None, subject: str | None = None) -> tuple[AuditLine, ...]:
        """Lines, the newest first: of one subject, and before a line where given."""
        query = select(AuditRow).order_by(AuditRow.id.desc()).limit(limit)
        if before is not None:
            query = query.where(AuditRow.id < before)
        if subject is not None:
            query = query.where(AuditRow.subject == subject)
        return tuple(_line(row) for row in self._session.scalars(query))

    def who_did(self, action: str, subject: str, times: Sequence[datetime]) -> dict[datetime, str]:
        """The persons who did an action on a subject, by time; other times have no key."""
        query = select(AuditRow.at, AuditRow.who).where(
            AuditRow.action == action, AuditRow.subject == subject, AuditRow.at.in_(times)
        )
        return {at: who for at, who in self._session.execute(query)}  # noqa: C416 - rows are no pairs

    def check(self, expect: str = "") -> AuditCheck:
        """Checks the chain from the first line, and whether a hash is in it where one is given."""
        last, lines, broken = FIRST, 0, None
        for row in self._session.scalars(select(AuditRow).order_by(AuditRow.id).execution_options(yield_per=1000)):
            lines += 1
            if broken is None and row.hash != _hash(last, row):
                broken = row.id
            last = row.hash
        return AuditCheck(lines, last, broken, self.has(expect) if expect else None)

    def has(self, hash: str) -> bool:
        """Whether the trail has a line of this hash."""
        return self._session.scalar(select(AuditRow.id).where(AuditRow.hash == hash).limit(1)) is not None

    def last(self) -> str:
        """The hash of the last line."""
        return self._session.scalar(select(AuditRow.hash).order_by(AuditRow.id.desc()).limit(1)) or FIRST


def _hash(last: str, row: AuditRow) -> str:
    at = row.at.isoformat(timespec="microseconds")
    line: list[Any] = [last, at, row.who, row.account, row.action, row.subject, row.details]
    return sha256(json.dumps(line, sort_keys=True, ensure_ascii=False).encode()).hexdigest()


def _line(row: AuditRow) -> AuditLine:
    return AuditLine(row.id, row.at, row.who, row.account, row.action, row.subject, row.details, row.hash)
