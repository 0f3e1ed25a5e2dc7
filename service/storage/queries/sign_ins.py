"""Signed-in browsers, and links that sign somebody in once."""

from datetime import datetime

from sqlalchemy import ColumnElement, delete, select, update

from service.records.identity import Account
from service.storage.identity_tables import AccountRow, SignInLinkRow, SignInRow
from service.storage.queries.accounts import account_of
from service.storage.queries.base import Queries


class SignIns(Queries):
    """By the hash of what a browser shows."""

    def add(self, account: Account, hashed: str, now: datetime, until: datetime) -> None:
        """A browser is signed in; those whose time is over are forgotten."""
        self._session.execute(delete(SignInRow).where(SignInRow.expires_at <= now))
        self._session.add(SignInRow(account_id=account.id, hash=hashed, created_at=now, expires_at=until))

    def shown(self, hashed: str, now: datetime) -> Account | None:
        """Who is signed in."""
        owner = select(AccountRow).join(SignInRow, SignInRow.account_id == AccountRow.id)
        holds = (SignInRow.hash == hashed, SignInRow.expires_at > now, AccountRow.is_active)
        row = self._session.scalar(owner.where(*holds))
        return None if row is None else account_of(row)

    def end(self, hashed: str) -> None:
        """A browser is signed out."""
        self._session.execute(delete(SignInRow).where(SignInRow.hash == hashed))

    def end_all(self, account: Account) -> None:
        """Every browser of an account is signed out."""
        self._session.execute(delete(SignInRow).where(SignInRow.account_id == account.id))

    def add_link(self, account: Account | None, hashed: str, now: datetime, until: datetime) -> None:
        """A link that can be used once; of nobody, it makes the first account."""
        key = None if account is None else account.id
        self._session.add(SignInLinkRow(account_id=key, hash=hashed, created_at=now, expires_at=until))

    def end_links(self, account: Account) -> None:
        """No other link of an account can be used any more."""
        own = SignInLinkRow.account_id == account.id, SignInLinkRow.used_at.is_(None)
        self._session.execute(delete(SignInLinkRow).where(*own))

    def link(self, hashed: str, now: datetime) -> tuple[bool, Account | None]:
        """Whether a link holds, and whom it signs in."""
        link = self._session.scalar(select(SignInLinkRow).where(*_holds(hashed, now)))
        if link is None:
            return False, None
        owner = None if link.account_id is None else self._session.get(AccountRow, link.account_id)
        return True, None if owner is None else account_of(owner)

    def use_link(self, hashed: str, now: datetime) -> bool:
        """Whether it was there to be used; of two at once one is told so."""
        used = update(SignInLinkRow).where(*_holds(hashed, now)).values(used_at=now).returning(SignInLinkRow.id)
        return self._session.scalar(used) is not None


def _holds(hashed: str, now: datetime) -> tuple[ColumnElement[bool], ...]:
    return SignInLinkRow.hash == hashed, SignInLinkRow.used_at.is_(None), SignInLinkRow.expires_at > now
