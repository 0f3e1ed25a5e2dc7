"""What the pages of signing in, and of one's own account, show."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from service.records.identity import Account, Role, Token


@dataclass(frozen=True)
class SignInPage:
    """Login and password."""

    next: str
    """Where it leads, an address of this service."""
    wrong: str
    """What was wrong the last time; empty the first time."""
    provider: str
    """What the provider that people may sign in at is called; empty where none is set."""


@dataclass(frozen=True)
class LinkPage:
    """What somebody fills in who opened a link."""

    secret: str
    account: Account | None
    """None where the first account of all is made."""
    shortest: int
    """Characters of a password."""


@dataclass(frozen=True)
class TokenLine:
    """One token in words."""

    token: Token
    state: str
    holds: bool


@dataclass(frozen=True)
class AccountPage:
    """One's own account."""

    tokens: tuple[TokenLine, ...]
    secret: str
    """Of the token that was just made; empty otherwise."""
    roles: tuple[Role, ...]


def account_page(tokens: Sequence[Token], now: datetime, secret: str = "") -> AccountPage:
    """The page of an account's tokens."""
    return AccountPage(tuple(_line(token, now) for token in tokens), secret, tuple(Role))


def _line(token: Token, now: datetime) -> TokenLine:
    if token.revoked_at is not None:
        return TokenLine(token, f"revoked on {token.revoked_at:%Y-%m-%d}", holds=False)
    if token.expires_at <= now:
        return TokenLine(token, f"expired on {token.expires_at:%Y-%m-%d}", holds=False)
    used = "never used" if token.last_used_at is None else f"last used on {token.last_used_at:%Y-%m-%d}"
    return TokenLine(token, f"holds until {token.expires_at:%Y-%m-%d}, {used}", holds=True)
