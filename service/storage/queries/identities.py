"""Who accounts are to a provider that signs people in."""

from datetime import datetime

from sqlalchemy import select

from service.records.identity import Account
from service.storage.identity_tables import AccountRow, IdentityRow
from service.storage.queries.accounts import account_of
from service.storage.queries.base import Queries


class Identities(Queries):
    """By issuer and subject, together."""

    def account(self, issuer: str, subject: str) -> Account | None:
        """Whose it is."""
        owner = select(AccountRow).join(IdentityRow, IdentityRow.account_id == AccountRow.id)
        row = self._session.scalar(owner.where(IdentityRow.issuer == issuer, IdentityRow.subject == subject))
        return None if row is None else account_of(row)

    def add(self, account: Account, issuer: str, subject: str, now: datetime) -> bool:
        """An account is somebody's from now on; whether nobody else's was."""
        return self.insert_once(IdentityRow, account_id=account.id, issuer=issuer, subject=subject, created_at=now)
