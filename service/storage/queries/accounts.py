"""Who may sign in."""

from datetime import datetime

from sqlalchemy import exists, func, select, update

from service.errors import NotFoundError
from service.records.identity import Account, Role
from service.storage.identity_tables import AccountRow
from service.storage.queries.base import Queries


class Accounts(Queries):
    """Accounts by login, which is kept in small letters."""

    def any(self) -> bool:
        """Whether there is an account at all."""
        return bool(self._session.scalar(select(exists().select_from(AccountRow))))

    def every(self) -> tuple[Account, ...]:
        """All accounts by login, those that may no longer sign in too."""
        return tuple(account_of(row) for row in self._session.scalars(select(AccountRow).order_by(AccountRow.login)))

    def get(self, login: str) -> Account:
        """One account."""
        return account_of(self._row(login))

    def hold_admins(self) -> None:
        """Holds every active administrator until the transaction ends, always in the same order: of two who demote each
        other at once, the second one sees what the first one did."""
        admins = select(AccountRow.id).where(AccountRow.role == Role.ADMIN, AccountRow.is_active)
        self._session.execute(admins.order_by(AccountRow.id).with_for_update()).all()

    def admins(self) -> int:
        """How many active accounts may do everything."""
        count = select(func.count()).select_from(AccountRow).where(AccountRow.role == Role.ADMIN, AccountRow.is_active)
        return self._session.scalar(count) or 0

    def add(self, login: str, name: str, role: Role, now: datetime) -> bool:
        """Makes an account without a password, and returns whether it is new."""
        values = {"login": login.lower(), "name": name, "role": role, "is_active": True, "created_at": now}
        return self.insert_once(AccountRow, **values)

    def put(self, login: str, *, name: str, role: Role, is_active: bool) -> None:
        """Changes an account."""
        row = self._row(login)
        row.name, row.role, row.is_active = name, role, is_active
        self._session.flush()

    def password_hash(self, login: str) -> str | None:
        """What is stored of the password; None without an account or a password, or where it may not sign in."""
        of = select(AccountRow.password_hash).where(AccountRow.login == login.lower(), AccountRow.is_active)
        return self._session.scalar(of)

    def put_password_hash(self, login: str, hashed: str) -> None:
        """Stores another password's hash."""
        own = AccountRow.login == login.lower()
        self._session.execute(update(AccountRow).where(own).values(password_hash=hashed))

    def _row(self, login: str) -> AccountRow:
        row = self._session.scalar(select(AccountRow).where(AccountRow.login == login.lower()))
        if row is None:
            raise NotFoundError(f"There is no account {login!r}.")
        return row


def account_of(row: AccountRow) -> Account:
    """As a record, without what is stored of the password."""
    return Account(
        id=row.id,
        login=row.login,
        name=row.name,
        role=Role(row.role),
        is_active=row.is_active,
        created_at=row.created_at,
        has_password=row.password_hash is not None,
    )
