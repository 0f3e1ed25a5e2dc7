"""What programs show instead of a password."""

from datetime import datetime, timedelta

from sqlalchemy import Select, select, update

from service.errors import NotFoundError
from service.records.identity import Account, Role, Token
from service.storage.identity_tables import AccountRow, TokenRow
from service.storage.queries.accounts import account_of
from service.storage.queries.base import Queries

USED_AGAIN = timedelta(hours=1)
"""How exactly the last use is known: a row is not written for every request."""


class Tokens(Queries):
    """Tokens by number, and by the hash of what is shown."""

    def add(self, account: Account, token: Token, hashed: str) -> Token:
        """Stores a token and returns it with its number."""
        row = TokenRow(
            account_id=account.id,
            label=token.label,
            role=token.role,
            hash=hashed,
            created_at=token.created_at,
            expires_at=token.expires_at,
        )
        self._session.add(row)
        self._session.flush()
        return _token(row, account.login)

    def every(self, login: str | None = None) -> tuple[Token, ...]:
        """All tokens, of one account where it is given, the newest first."""
        wanted = _tokens().order_by(TokenRow.id.desc())
        if login is not None:
            wanted = wanted.where(AccountRow.login == login.lower())
        return tuple(_token(row, owner.login) for row, owner in self._session.execute(wanted))

    def get(self, id: int) -> Token:
        """One token."""
        found = self._session.execute(_tokens().where(TokenRow.id == id)).one_or_none()
        if found is None:
            raise NotFoundError(f"There is no token {id}.")
        return _token(found[0], found[1].login)

    def shown(self, hashed: str, now: datetime) -> tuple[Token, Account] | None:
        """The token of a hash with its account, while both hold."""
        holds = (
            TokenRow.hash == hashed,
            TokenRow.expires_at > now,
            TokenRow.revoked_at.is_(None),
            AccountRow.is_active,
        )
        found = self._session.execute(_tokens().where(*holds)).one_or_none()
        return None if found is None else (_token(found[0], found[1].login), account_of(found[1]))

    def used(self, id: int, now: datetime) -> None:
        """Notes that a token was shown."""
        self._session.execute(update(TokenRow).where(TokenRow.id == id).values(last_used_at=now))

    def revoke(self, id: int, now: datetime) -> None:
        """From now on nobody gets in with it."""
        self._session.execute(
            update(TokenRow).where(TokenRow.id == id, TokenRow.revoked_at.is_(None)).values(revoked_at=now)
        )

    def revoke_all(self, account: Account, now: datetime) -> tuple[int, ...]:
        """The same of every token of an account that is not revoked; returns their numbers."""
        own = TokenRow.account_id == account.id, TokenRow.revoked_at.is_(None)
        revoked = update(TokenRow).where(*own).values(revoked_at=now).returning(TokenRow.id)
        return tuple(sorted(self._session.scalars(revoked)))


def is_stale(token: Token, now: datetime) -> bool:
    """Whether the last use is worth noting again."""
    return token.last_used_at is None or now - token.last_used_at > USED_AGAIN


def _tokens() -> Select[TokenRow, AccountRow]:
    return select(TokenRow, AccountRow).join(AccountRow, AccountRow.id == TokenRow.account_id)


def _token(row: TokenRow, login: str) -> Token:
    return Token(
        id=row.id,
        login=login,
        label=row.label,
        role=Role(row.role),
        created_at=row.created_at,
        expires_at=row.expires_at,
        revoked_at=row.revoked_at,
        last_used_at=row.last_used_at,
    )
