"""What the pages of accounts and of the audit trail show."""

import json
from collections.abc import Sequence
from dataclasses import dataclass

from service.records.audit import AuditCheck, AuditLine
from service.records.identity import Account, Role


@dataclass(frozen=True)
class AccountsPage:
    """Everybody who may sign in, or once might."""

    accounts: tuple[Account, ...]
    roles: tuple[Role, ...]
    login: str
    """Whose link was just made; empty otherwise."""
    link: str


@dataclass(frozen=True)
class AuditPage:
    """A part of the trail."""

    lines: tuple[tuple[AuditLine, str], ...]
    """With what else is known of each, in words."""
    check: AuditCheck | None
    subject: str
    before: int | None
    """Where the next part begins."""


def audit_page(lines: Sequence[AuditLine], check: AuditCheck | None, subject: str, most: int) -> AuditPage:
    """The page of some lines of the trail."""
    told = tuple((line, _in_words(line)) for line in lines)
    return AuditPage(told, check, subject, lines[-1].id if len(lines) == most else None)


def _in_words(line: AuditLine) -> str:
    """``why: wrong cable; before: crew``."""
    return "; ".join(f"{name}: {_plain(value)}" for name, value in line.details.items() if value not in (None, "", {}))


def _plain(value: object) -> str:
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
