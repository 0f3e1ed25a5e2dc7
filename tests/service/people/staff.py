"""People with accounts, as tests need them: one of every role, signed in by token."""

from collections.abc import Collection
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

from service.kit.person import Role
from service.people.changes import LinkForm, add_account, make_link, make_token, use_link
from service.storage import Storage

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
PASSWORD = "correct horse battery"
"""Password of everybody."""


@dataclass(frozen=True)
class Staff:
    """Headers of a token for each role."""

    tokens: dict[Role, str]

    def headers(self, role: Role | None) -> dict[str, str]:
        """Headers of a role; none for nobody."""
        return {} if role is None else {"Authorization": f"Bearer {self.tokens[role]}"}


def staffed(storage: Storage, now: datetime = NOW, signing: Collection[str] = ()) -> Staff:
    """One account of every role, named after it, each with a token that holds for a year; of some a password too, which
    is chosen first: it would revoke the token."""
    tokens = {}
    for role in reversed(Role):
        add_account(storage, role, role.title(), role, now, who="test")
        if role in signing:
            with_password(storage, role, now)
        year = timedelta(days=365)
        tokens[role] = make_token(storage, role, "bench", role, now, lifetime=year, who="test")[1]
    return Staff(tokens)


def with_password(storage: Storage, login: str, now: datetime = NOW) -> None:
    """Chooses the password of an account."""
    use_link(storage, make_link(storage, login, now, "test"), LinkForm("", "", PASSWORD), now)
