"""Who somebody is, accounts, tokens and the audit trail."""

from datetime import timedelta
from typing import Annotated

from fastapi import APIRouter, Query

from service.admission import PersonOf
from service.api.schemas.fields import Limit, Number, Text
from service.api.schemas.identity import (
    AccountChanges,
    AccountList,
    AuditPage,
    LinkSchema,
    Login,
    MadeToken,
    MeSchema,
    NewAccount,
    NewToken,
    TokenList,
)
from service.api.schemas.problem import errors
from service.dependencies import Now, Reading, StorageOf
from service.errors import ConflictError, ForbiddenError
from service.flows.identity.accounts import AccountChange, add_account, change_account
from service.flows.identity.links import make_link
from service.flows.identity.tokens import make_token, require_may_revoke, require_no_token, revoke_token
from service.records.audit import AuditCheck
from service.records.identity import UNNAMED, Account, Role

router = APIRouter(tags=["accounts"])
NO_ACCOUNT = "A token acts for an account: make the first account, and sign in with it."


@router.get("/me", responses=errors())
def read_me(person: PersonOf) -> MeSchema:
    """Who sent this request, and what they may do."""
    return MeSchema.model_validate(person)


@router.get("/accounts", responses=errors())
def list_accounts(store: Reading) -> AccountList:
    """Everybody who may sign in, or once might."""
    return AccountList(accounts=store.accounts.every())


@router.post("/accounts", status_code=201, responses=errors(400, 409, 422))
def create_account(new: NewAccount, storage: StorageOf, now: Now, person: PersonOf) -> Account:
    """Make an account. A link lets its owner choose a password; from the first account on everybody must sign in."""
    made = add_account(storage, new.login, new.name, new.role, now, who=person.signs(UNNAMED))
    return made


@router.put("/accounts/{login}", responses=errors(400, 404, 409, 422))
def update_account(login: Login, changes: AccountChanges, storage: StorageOf, now: Now, person: PersonOf) -> Account:
    """Another name or role, or the account may no longer sign in. Accounts are never deleted."""
    change = AccountChange(changes.name, changes.role, changes.is_active)
    return change_account(storage, login, change, now, who=person.signs(UNNAMED))


@router.post("/accounts/{login}/link", status_code=201, responses=errors(403, 404, 422))
def create_link(login: Login, storage: StorageOf, now: Now, person: PersonOf) -> LinkSchema:
    """A link with which the account's owner chooses a password and is signed in, once, within an hour. A token makes
    none."""
    require_no_token(person)
    return LinkSchema(path=f"/sign-in/{make_link(storage, login, now, person.signs(UNNAMED))}")


@router.get("/tokens", responses=errors())
def list_tokens(store: Reading, person: PersonOf) -> TokenList:
    """One's own tokens; an administrator sees all."""
    tokens = store.tokens.every(None if person.may(Role.ADMIN) else person.login)
    return TokenList(tokens=tokens)


@router.post("/tokens", status_code=201, responses=errors(400, 403, 409, 422))
def create_token(new: NewToken, storage: StorageOf, now: Now, person: PersonOf) -> MadeToken:
    """A token of one's own, for somebody who is signed in: a token makes none. Its secret is in this answer alone."""
    require_no_token(person)
    if not person.login:
        raise ConflictError(NO_ACCOUNT)
    if not person.may(new.role):
        raise ForbiddenError(f"{person.account} is {person.role} and cannot make a token for {new.role}.")
    lasts = timedelta(days=new.days)
    token, secret = make_token(storage, person.login, new.label, new.role, now, lasts=lasts, who=person.name)
    return MadeToken(**vars(token), secret=secret)


@router.delete("/tokens/{id}", status_code=204, responses=errors(403, 404, 422))
def delete_token(id: Number, storage: StorageOf, store: Reading, now: Now, person: PersonOf) -> None:
    """Nobody gets in with the token any more; it stays listed. Others' tokens need an administrator who is signed in: a
    token revokes only itself."""
    require_may_revoke(person, store.tokens.get(id))
    revoke_token(storage, id, now, who=person.signs(UNNAMED))


@router.get("/audit", responses=errors(422))
def read_audit(
    store: Reading,
    limit: Limit = 100,
    before: Annotated[int | None, Query(ge=1, le=2_000_000_000, description="Lines before this one.")] = None,
    subject: Annotated[Text | None, Query(description="Only what was done to this.")] = None,
) -> AuditPage:
    """The audit trail, newest first."""
    lines = store.audit.page(limit, before, subject)
    return AuditPage(lines=lines, before=lines[-1].id if len(lines) == limit else None)


@router.get("/audit/check", responses=errors())
def check_audit(store: Reading) -> AuditCheck:
    """Work out the chain of the whole trail again."""
    return store.audit.check()
