"""Accounts, tokens, signed-in browsers, and attempts to sign in."""

from datetime import datetime, timedelta

from sqlalchemy import ColumnElement, Select, case, delete, exists, func, select, update
from sqlalchemy.dialects import postgresql, sqlite

from estimator.message import say
from service.errors import NotFoundError
from service.kit.person import Account, Role, Token
from service.people.tables import AccountRow, AttemptRow, IdentityRow, SignInLinkRow, SignInRow, TokenRow
from service.storage.queries import Queries


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
            raise NotFoundError(say("There is no account {login}.", login=repr(login)))
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


FORGOTTEN = timedelta(days=2)
"""After which a row is removed; long after every window, so that nobody else is at it."""


class Attempts(Queries):
    """Attempts by key; a statement that counts also tells, so that of two at once each sees its own number."""

    def count(self, key: str, window: timedelta, now: datetime) -> int:
        """Counts one more, and returns how many there were within the window that the first one opened, this one
        included."""
        insert = postgresql.insert if self._session.get_bind().dialect.name == "postgresql" else sqlite.insert
        is_over = AttemptRow.since <= now - window
        counted = insert(AttemptRow).values(key=key, since=now, count=1)
        counted = counted.on_conflict_do_update(
            index_elements=[AttemptRow.key],
            set_={
                "count": case((is_over, 1), else_=AttemptRow.count + 1),
                "since": case((is_over, now), else_=AttemptRow.since),
            },
        )
        return self._session.scalars(counted.returning(AttemptRow.count)).one()

    def take_back(self, key: str) -> None:
        """One was right after all."""
        own = AttemptRow.key == key, AttemptRow.count > 0
        self._session.execute(update(AttemptRow).where(*own).values(count=AttemptRow.count - 1))

    def forget(self, key: str) -> None:
        """All that were counted."""
        self._session.execute(update(AttemptRow).where(AttemptRow.key == key).values(count=0))

    def forget_old(self, now: datetime) -> None:
        """Rows that nobody needs."""
        self._session.execute(delete(AttemptRow).where(AttemptRow.since <= now - FORGOTTEN))


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
            raise NotFoundError(say("There is no token {id}.", id=id))
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
