"""Flow: tokens are made and revoked."""

from datetime import datetime, timedelta

from estimator.errors import Problem
from service.errors import ConflictError, ForbiddenError, RefusedError
from service.identity.secret import TOKEN_PREFIX, new_secret, stored_hash
from service.records.identity import Person, Role, Token
from service.storage import Storage

LONGEST = timedelta(days=366)
"""That a token may hold: what nobody remembers should end by itself."""


OUTLIVES = "A token makes no tokens and no sign-in links, which would outlive it: sign in with a browser."
OTHERS = "This token is another account's."
NOT_ITSELF = "A token revokes none but itself: sign in with a browser."


def require_no_token(person: Person) -> None:
    """ForbiddenError where a token asks for something that lets somebody in for longer than the token does."""
    if person.token:
        raise ForbiddenError(OUTLIVES)


def require_may_revoke(person: Person, token: Token) -> None:
    """ForbiddenError unless a token is somebody's own, or an administrator asks; a token revokes only itself."""
    if token.login != person.login and not person.may(Role.ADMIN):
        raise ForbiddenError(OTHERS)
    if person.token and person.token_id != token.id:
        raise ForbiddenError(NOT_ITSELF)


def make_token(
    storage: Storage, login: str, label: str, role: Role, now: datetime, *, lasts: timedelta, who: str
) -> tuple[Token, str]:
    """A token for an account with the secret to show, which is not kept; it may do at most what its account may."""
    if not timedelta(0) < lasts <= LONGEST:
        fault = Problem("days", f"must be from 1 to {LONGEST.days}")
        raise RefusedError("The token cannot be made.", (fault,))
    secret = TOKEN_PREFIX + new_secret()
    with storage.database.writing() as store:
        account = store.accounts.get(login)
        if not account.is_active or not account.role.may(role):
            raise ConflictError(f"{account.login} is {account.role} and cannot have a token for {role}.")
        new = Token(0, account.login, label.strip() or "token", role, now, now + lasts, None, None)
        token = store.tokens.add(account, new, stored_hash(secret))
        details = {"token": token.id, "label": token.label, "role": role, "until": token.expires_at.isoformat()}
        store.audit.write(now, who, "make token", account.login, details)
    return token, secret


def revoke_token(storage: Storage, id: int, now: datetime, *, who: str) -> Token:
    """Nobody gets in with it any more; again it changes nothing."""
    with storage.database.writing() as store:
        token = store.tokens.get(id)
        if token.revoked_at is None:
            store.tokens.revoke(id, now)
            store.audit.write(now, who, "revoke token", token.login, {"token": id, "label": token.label})
        return store.tokens.get(id)
