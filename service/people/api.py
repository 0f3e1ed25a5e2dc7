"""The sender's identity, accounts, tokens and the audit trail, over HTTP."""

from dataclasses import dataclass
from datetime import timedelta
from typing import Annotated

from fastapi import APIRouter, Path, Query
from pydantic import BaseModel, ConfigDict, Field

from service.errors import ConflictError, ForbiddenError
from service.kit.answer import answer
from service.kit.person import UNNAMED, Account, Role, Token
from service.people.admission import PersonOf
from service.people.changes import (
    AccountChange,
    add_account,
    change_account,
    make_link,
    make_token,
    require_no_token,
    revoke_token,
)
from service.people.dependencies import StorageOf
from service.people.store import Accounts, Tokens
from service.storage.audit import Audit, AuditCheck, AuditLine
from service.web.dependencies import Now, Reading
from service.web.fields import Body, Limit, Name, Number, Sought, Text
from service.web.problem_document import errors

Login = Annotated[Sought, Path(max_length=60, description="The account's login.", examples=["k.ito"])]


class MeSchema(BaseModel):
    """Sender of the request."""

    model_config = ConfigDict(from_attributes=True)

    login: str = Field(description="Account; empty where nobody needs to sign in.")
    name: str = Field(description="Under what this person does.")
    role: Role = Field(description="What this person may do.")
    token: str = Field(description="Label of the token that was shown; empty of a browser.")


class AccountList(BaseModel):
    """All accounts."""

    accounts: tuple[Account, ...] = Field(description="By login.")


class NewAccount(Body, json_schema_extra={"example": {"login": "k.ito", "name": "K. Ito", "role": "crew"}}):
    """A new account."""

    login: Name = Field(
        description="Letters a to z, digits and . _ @ -; at most 60. Capitals are made small.",
        json_schema_extra={"pattern": r"^[A-Za-z0-9][A-Za-z0-9._@-]{0,59}$"},
    )
    name: Text = Field(default="", description="As papers name the person; the login without it.")
    role: Role = Field(description="What the person may do.")


class AccountChanges(Body, json_schema_extra={"example": {"role": "engineer"}}):
    """Changes of an account."""

    name: Text | None = Field(default=None, description="As papers name the person.")
    role: Role | None = Field(default=None, description="What the person may do.")
    is_active: bool | None = Field(default=None, description="Whether the person may sign in.")


class LinkSchema(BaseModel):
    """A link that signs somebody in once."""

    path: str = Field(description="Below the address of this service; holds for an hour.")


class TokenList(BaseModel):
    """Tokens."""

    tokens: tuple[Token, ...] = Field(description="Newest first.")


class NewToken(Body, json_schema_extra={"example": {"label": "bench 3", "role": "crew", "days": 90}}):
    """A token that is to be made for the one who asks."""

    label: Name = Field(description="What it is for.")
    role: Role = Field(description="What it may do; at most what its account may.")
    days: int = Field(default=90, ge=1, le=366, description="How long it holds.")


@answer
@dataclass(frozen=True)
class MadeToken(Token):
    """A new token with its secret."""

    secret: str
    """Secret that the program shows: `Authorization: Bearer …`. It is not shown again."""


class AuditPage(BaseModel):
    """A part of the trail."""

    lines: tuple[AuditLine, ...] = Field(description="Newest first.")
    before: int | None = Field(description="Give this for the part before; null where there is none.")


router = APIRouter(tags=["accounts"])
NO_ACCOUNT = "A token acts for an account: make the first account, and sign in with it."


@router.get("/me", responses=errors())
def read_me(person: PersonOf) -> MeSchema:
    """The sender of this request, and their role."""
    return MeSchema.model_validate(person)


@router.get("/accounts", responses=errors())
def list_accounts(store: Reading) -> AccountList:
    """The accounts of everybody who may sign in, or once might."""
    return AccountList(accounts=Accounts(store).every())


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
    tokens = Tokens(store).every(None if person.may(Role.ADMIN) else person.login)
    return TokenList(tokens=tokens)


@router.post("/tokens", status_code=201, responses=errors(400, 403, 409, 422))
def create_token(new: NewToken, storage: StorageOf, now: Now, person: PersonOf) -> MadeToken:
    """A token of one's own, for somebody who is signed in: a token makes none. Its secret is in this answer alone."""
    require_no_token(person)
    if not person.login:
        raise ConflictError(NO_ACCOUNT)
    if not person.may(new.role):
        parts = {"account": person.account, "role": person.role, "wanted_role": new.role}
        raise ForbiddenError("{account} is {role} and cannot make a token for {wanted_role}.", **parts)
    lasts = timedelta(days=new.days)
    token, secret = make_token(storage, person.login, new.label, new.role, now, lifetime=lasts, who=person.name)
    return MadeToken(**vars(token), secret=secret)


@router.delete("/tokens/{id}", status_code=204, responses=errors(403, 404, 422))
def delete_token(id: Number, storage: StorageOf, now: Now, person: PersonOf) -> None:
    """Nobody gets in with the token any more; it stays listed. Others' tokens need an administrator who is signed in: a
    token revokes only itself."""
    revoke_token(storage, id, person, now, who=person.signs(UNNAMED))


@router.get("/audit", responses=errors(422))
def read_audit(
    store: Reading,
    limit: Limit = 100,
    before: Annotated[int | None, Query(ge=1, le=2_000_000_000, description="Lines before this one.")] = None,
    subject: Annotated[Sought | None, Query(description="Only what was done to this.")] = None,
) -> AuditPage:
    """The audit trail, newest first."""
    lines = Audit(store).page(limit, before, subject)
    return AuditPage(lines=lines, before=lines[-1].id if len(lines) == limit else None)


@router.get("/audit/check", responses=errors(422))
def check_audit(
    store: Reading,
    expect: Annotated[Sought, Query(description="A last hash that was noted before; it must still be there.")] = "",
) -> AuditCheck:
    """Work out the chain of the whole trail again. Note the last hash elsewhere: it shows later that none was cut."""
    return Audit(store).check(expect)
