"""Accounts, tokens and the audit trail."""

from datetime import datetime
from typing import Annotated, Any

from fastapi import Path
from pydantic import BaseModel, ConfigDict, Field

from service.api.schemas.fields import TEXT, Said, Text
from service.records.identity import Role

Login = Annotated[str, Path(pattern=TEXT, max_length=60, description="The account's login.", examples=["k.ito"])]


class MeSchema(BaseModel):
    """Who sent the request."""

    model_config = ConfigDict(from_attributes=True)

    login: str = Field(description="Account; empty where nobody needs to sign in.")
    name: str = Field(description="Under what this person does.")
    role: Role = Field(description="What this person may do.")
    token: str = Field(description="Label of the token that was shown; empty of a browser.")


class AccountSchema(BaseModel):
    """Somebody who may sign in."""

    model_config = ConfigDict(from_attributes=True)

    login: str = Field(description="What the person signs in with.")
    name: str = Field(description="As papers, flags and the audit trail name the person.")
    role: Role = Field(description="What the person may do.")
    is_active: bool = Field(description="Whether the person may sign in.")
    has_password: bool = Field(description="Whether a password was chosen already.")
    created_at: datetime = Field(description="When, UTC.")


class AccountList(BaseModel):
    """All accounts."""

    accounts: list[AccountSchema] = Field(description="By login.")


class NewAccount(BaseModel):
    """Somebody who is to sign in."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"login": "k.ito", "name": "K. Ito", "role": "crew"}}
    )

    login: Said = Field(
        description="Letters a to z, digits and . _ @ -; at most 60. Capitals are made small.",
        json_schema_extra={"pattern": r"^[A-Za-z0-9][A-Za-z0-9._@-]{0,59}$"},
    )
    name: Text = Field(default="", description="As papers name the person; the login without it.")
    role: Role = Field(description="What the person may do.")


class AccountChanges(BaseModel):
    """What is to be otherwise."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {"role": "engineer"}})

    name: Text | None = Field(default=None, description="As papers name the person.")
    role: Role | None = Field(default=None, description="What the person may do.")
    is_active: bool | None = Field(default=None, description="Whether the person may sign in.")


class LinkSchema(BaseModel):
    """A link that signs somebody in once."""

    path: str = Field(description="Below the address of this service; holds for an hour.")


class TokenSchema(BaseModel):
    """What a program shows instead of a password."""

    model_config = ConfigDict(from_attributes=True)

    id: int = Field(description="Number of the token.")
    login: str = Field(description="Account that it acts for.")
    label: str = Field(description="What it is for.")
    role: Role = Field(description="At most this, and never more than its account may.")
    created_at: datetime = Field(description="When, UTC.")
    expires_at: datetime = Field(description="Until when it holds, UTC.")
    revoked_at: datetime | None = Field(description="When it was revoked, UTC.")
    last_used_at: datetime | None = Field(description="To the hour, UTC.")


class TokenList(BaseModel):
    """Tokens."""

    tokens: list[TokenSchema] = Field(description="Newest first.")


class NewToken(BaseModel):
    """A token that is to be made for the one who asks."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"label": "bench 3", "role": "crew", "days": 90}}
    )

    label: Said = Field(description="What it is for.")
    role: Role = Field(description="What it may do; at most what its account may.")
    days: int = Field(default=90, ge=1, le=366, description="How long it holds.")


class MadeToken(TokenSchema):
    """A new token with its secret."""

    secret: str = Field(description="What the program shows: `Authorization: Bearer …`. It is not shown again.")


class AuditLineSchema(BaseModel):
    """Who did what when."""

    model_config = ConfigDict(from_attributes=True)

    id: int = Field(description="Number of the line.")
    at: datetime = Field(description="When, UTC.")
    who: str = Field(description="As they said, or as their account is named.")
    account: str = Field(description="Account that was signed in, with the token that acted for it.")
    action: str = Field(description="What was done.")
    subject: str = Field(description="To what: a session, a unit, a type, a stand, an account.")
    details: dict[str, Any] = Field(description="What before, what after and why, as far as the action has them.")
    hash: str = Field(description="SHA-256 of this line and of the one before it.")


class AuditPage(BaseModel):
    """A part of the trail."""

    lines: list[AuditLineSchema] = Field(description="Newest first.")
    before: int | None = Field(description="Give this for the part before; null where there is none.")


class AuditCheckSchema(BaseModel):
    """Whether the trail is as it was written."""

    model_config = ConfigDict(from_attributes=True)

    lines: int = Field(description="How many there are.")
    last: str = Field(description="Hash of the last line; kept elsewhere, it shows later that none was cut off.")
    broken: int | None = Field(description="First line that does not follow from the ones before it; null: none.")
