"""Accounts, tokens, signed-in browsers, and attempts to sign in."""

from datetime import datetime, timedelta

from sqlalchemy import ColumnElement, Select, case, delete, exists, func, select, update
from sqlalchemy.dialects import postgresql, sqlite

from service.errors import NotFoundError
from service.kit.copying import copied
from service.kit.person import Account, Role, Token
from service.people.tables import AccountRow, AttemptRow, IdentityRow, SignInLinkRow, SignInRow, TokenRow
from service.storage.queries import Queries


class Accounts(Queries):
    """Accounts by login, which is stored in lower case."""

    def any(self) -> bool:
        """Whether there is any account."""
        return bool(self._session.scalar(select(exists().select_from(AccountRow))))

    def every(self) -> tuple[Account, ...]:
        """All accounts by login, active or not."""
        return tuple(account_of(row) for row in self._session.scalars(select(AccountRow).order_by(AccountRow.login)))

    def get(self, login: str) -> Account:
        """One account."""
        return account_of(self._row(login))

    def hold_admins(self) -> None:
        """Locks every active administrator until the transaction ends, in a fixed order: of two who demote each other
        at once, the second one sees what the first one did."""
        admins = select(AccountRow.id).where(AccountRow.role == Role.ADMIN, AccountRow.is_active)
        self._session.execute(admins.order_by(AccountRow.id).with_for_update()).all()

    def admins(self) -> int:
        """Number of active administrators."""
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
        """Stored hash of the password; None without an account or a password, or for an inactive account."""
        query = select(AccountRow.password_hash).where(AccountRow.login == login.lower(), AccountRow.is_active)
        return self._session.scalar(query)

    def put_password_hash(self, login: str, hashed: str) -> None:
        """Stores the hash of a new password."""
        is_account = AccountRow.login == login.lower()
        self._session.execute(update(AccountRow).where(is_account).values(password_hash=hashed))

    def _row(self, login: str) -> AccountRow:
        row = self._session.scalar(select(AccountRow).where(AccountRow.login == login.lower()))
        if row is None:
            raise NotFoundError("There is no account {login}.", login=repr(login))
        return row


def account_of(row: AccountRow) -> Account:
    """The record, without the password hash."""
    return copied(Account, row, has_password=row.password_hash is not None)


RETENTION = timedelta(days=2)
"""Age at which a row is removed; long after every window, so that it is not in use."""


class Attempts(Queries):
    """Attempts by key; one statement counts and returns, so that concurrent attempts get different numbers."""

    def count(self, key: str, window: timedelta, now: datetime) -> int:
        """Counts an attempt, and returns the number of attempts within the current window, this one included."""
        insert = postgresql.insert if self._session.get_bind().dialect.name == "postgresql" else sqlite.insert
        is_over = AttemptRow.since <= now - window
        statement = insert(AttemptRow).values(key=key, since=now, count=1)
        statement = statement.on_conflict_do_update(
            index_elements=[AttemptRow.key],
            set_={
                "count": case((is_over, 1), else_=AttemptRow.count + 1),
                "since": case((is_over, now), else_=AttemptRow.since),
            },
        )
        return self._session.scalars(statement.returning(AttemptRow.count)).one()

    def take_back(self, key: str) -> None:
        """Subtracts a right attempt."""
        conditions = AttemptRow.key == key, AttemptRow.count > 0
        self._session.execute(update(AttemptRow).where(*conditions).values(count=AttemptRow.count - 1))

    def forget(self, key: str) -> None:
        """Resets the count."""
        self._session.execute(update(AttemptRow).where(AttemptRow.key == key).values(count=0))

    def forget_old(self, now: datetime) -> None:
        """Removes old rows."""
        self._session.execute(delete(AttemptRow).where(AttemptRow.since <= now - RETENTION))


class Identities(Queries):
    """Identities by issuer and subject together."""

    def account(self, issuer: str, subject: str) -> Account | None:
        """The account of an identity."""
        owner = select(AccountRow).join(IdentityRow, IdentityRow.account_id == AccountRow.id)
        row = self._session.scalar(owner.where(IdentityRow.issuer == issuer, IdentityRow.subject == subject))
        return None if row is None else account_of(row)

    def add(self, account: Account, issuer: str, subject: str, now: datetime) -> bool:
        """Connects an account with an identity; whether the identity was free."""
        return self.insert_once(IdentityRow, account_id=account.id, issuer=issuer, subject=subject, created_at=now)


class SignIns(Queries):
    """Signed-in browsers by the hash of their secret."""

    def add(self, account: Account, hashed: str, now: datetime, until: datetime) -> None:
        """Adds a signed-in browser; removes expired ones."""
        self._session.execute(delete(SignInRow).where(SignInRow.expires_at <= now))
        self._session.add(SignInRow(account_id=account.id, hash=hashed, created_at=now, expires_at=until))

    def shown(self, hashed: str, now: datetime) -> Account | None:
        """The account of a signed-in browser."""
        owner = select(AccountRow).join(SignInRow, SignInRow.account_id == AccountRow.id)
        is_valid = (SignInRow.hash == hashed, SignInRow.expires_at > now, AccountRow.is_active)
        row = self._session.scalar(owner.where(*is_valid))
        return None if row is None else account_of(row)

    def end(self, hashed: str) -> None:
        """Signs a browser out."""
        self._session.execute(delete(SignInRow).where(SignInRow.hash == hashed))

    def end_all(self, account: Account) -> None:
        """Signs out every browser of an account."""
        self._session.execute(delete(SignInRow).where(SignInRow.account_id == account.id))

    def add_link(self, account: Account | None, hashed: str, now: datetime, until: datetime) -> None:
        """Adds a link for one use; without an account, it makes the first one."""
        key = None if account is None else account.id
        self._session.add(SignInLinkRow(account_id=key, hash=hashed, created_at=now, expires_at=until))

    def end_links(self, account: Account) -> None:
        """Ends the unused links of an account."""
        conditions = SignInLinkRow.account_id == account.id, SignInLinkRow.used_at.is_(None)
        self._session.execute(delete(SignInLinkRow).where(*conditions))

    def link(self, hashed: str, now: datetime) -> tuple[bool, Account | None]:
        """Whether a link is valid, and its account."""
        link = self._session.scalar(select(SignInLinkRow).where(*_is_valid(hashed, now)))
        if link is None:
            return False, None
        owner = None if link.account_id is None else self._session.get(AccountRow, link.account_id)
        return True, None if owner is None else account_of(owner)

    def use_link(self, hashed: str, now: datetime) -> bool:
        """Uses a link; of two concurrent uses only one succeeds."""
        statement = update(SignInLinkRow).where(*_is_valid(hashed, now)).values(used_at=now).returning(SignInLinkRow.id)
        return self._session.scalar(statement) is not None


def _is_valid(hashed: str, now: datetime) -> tuple[ColumnElement[bool], ...]:
    return SignInLinkRow.hash == hashed, SignInLinkRow.used_at.is_(None), SignInLinkRow.expires_at > now


USE_RESOLUTION = timedelta(hours=1)
"""Resolution of the last use: a row is not written for every request."""


class Tokens(Queries):
    """Tokens by number, and by the hash of their secret."""

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
        """All tokens, of one account where given, the newest first."""
        query = _tokens().order_by(TokenRow.id.desc())
        if login is not None:
            query = query.where(AccountRow.login == login.lower())
        return tuple(_token(row, owner.login) for row, owner in self._session.execute(query))

    def get(self, id: int) -> Token:
        """One token."""
        row = self._session.execute(_tokens().where(TokenRow.id == id)).one_or_none()
        if row is None:
            raise NotFoundError("There is no token {id}.", id=id)
        return _token(row[0], row[1].login)

    def shown(self, hashed: str, now: datetime) -> tuple[Token, Account] | None:
        """The valid token of a hash with its active account."""
        is_valid = (
            TokenRow.hash == hashed,
            TokenRow.expires_at > now,
            TokenRow.revoked_at.is_(None),
            AccountRow.is_active,
        )
        row = self._session.execute(_tokens().where(*is_valid)).one_or_none()
        return None if row is None else (_token(row[0], row[1].login), account_of(row[1]))

    def used(self, id: int, now: datetime) -> None:
        """Records the use of a token."""
        self._session.execute(update(TokenRow).where(TokenRow.id == id).values(last_used_at=now))

    def revoke(self, id: int, now: datetime) -> None:
        """Revokes a token."""
        self._session.execute(
            update(TokenRow).where(TokenRow.id == id, TokenRow.revoked_at.is_(None)).values(revoked_at=now)
        )

    def revoke_all(self, account: Account, now: datetime) -> tuple[int, ...]:
        """Revokes all tokens of an account; returns the numbers of those that were valid."""
        conditions = TokenRow.account_id == account.id, TokenRow.revoked_at.is_(None)
        statement = update(TokenRow).where(*conditions).values(revoked_at=now).returning(TokenRow.id)
        return tuple(sorted(self._session.scalars(statement)))


def is_stale(token: Token, now: datetime) -> bool:
    """Whether the last use is worth recording again."""
    return token.last_used_at is None or now - token.last_used_at > USE_RESOLUTION


def _tokens() -> Select[TokenRow, AccountRow]:
    return select(TokenRow, AccountRow).join(AccountRow, AccountRow.id == TokenRow.account_id)


def _token(row: TokenRow, login: str) -> Token:
    return copied(Token, row, login=login)
