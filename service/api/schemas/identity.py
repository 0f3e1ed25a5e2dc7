"""Accounts, tokens and the audit trail."""

from dataclasses import dataclass
from typing import Annotated

from fastapi import Path
from pydantic import BaseModel, ConfigDict, Field

from service.api.schemas.fields import TEXT, Said, Text
from service.records.answer import answer
from service.records.audit import AuditLine
from service.records.identity import Account, Role, Token

Login = Annotated[str, Path(pattern=TEXT, max_length=60, description="The account's login.", examples=["k.ito"])]


class MeSchema(BaseModel):
    """Who sent the request."""

    model_config = ConfigDict(from_attributes=True)

    login: str = Field(description="Account; empty where nobody needs to sign in.")
    name: str = Field(description="Under what this person does.")
    role: Role = Field(description="What this person may do.")
    token: str = Field(description="Label of the token that was shown; empty of a browser.")


class AccountList(BaseModel):
    """All accounts."""

    accounts: tuple[Account, ...] = Field(description="By login.")


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


class TokenList(BaseModel):
    """Tokens."""

    tokens: tuple[Token, ...] = Field(description="Newest first.")


class NewToken(BaseModel):
    """A token that is to be made for the one who asks."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"label": "bench 3", "role": "crew", "days": 90}}
    )

    label: Said = Field(description="What it is for.")
    role: Role = Field(description="What it may do; at most what its account may.")
    days: int = Field(default=90, ge=1, le=366, description="How long it holds.")


@answer
@dataclass(frozen=True)
class MadeToken(Token):
    """A new token with its secret."""

    secret: str
    """What the program shows: `Authorization: Bearer …`. It is not shown again."""


class AuditPage(BaseModel):
    """A part of the trail."""

    lines: tuple[AuditLine, ...] = Field(description="Newest first.")
    before: int | None = Field(description="Give this for the part before; null where there is none.")
