"""The sender of a request: people with an account, programs with a token, and their roles."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from estimator.message import say
from service.kit.answer import Hidden, answer


class Role(StrEnum):
    """Rights of a person or program; each role includes the ones before it."""

    VIEWER = "viewer"
    """Reads."""
    CREW = "crew"
    """Uploads, writes notes, records services, looks after flags."""
    ENGINEER = "engineer"
    """Judges: accepts and withdraws records, chooses references, accepts models, sets tolerances, issues papers."""
    ADMIN = "admin"
    """Accounts, tokens of others, webhooks, the audit trail."""

    def may(self, needed: "Role") -> bool:
        """Whether this role includes another."""
        return RANKS[self] >= RANKS[needed]


RANKS = {role: rank for rank, role in enumerate(Role)}
"""Rank of each role; a role includes all of lower rank."""


@answer
@dataclass(frozen=True)
class Account:
    """Somebody who may sign in."""

    id: Hidden[int]
    login: str
    """Name with which the person signs in."""
    name: str
    """Name of the person on papers, flags and the audit trail."""
    role: Role
    """Role of the person."""
    is_active: bool
    """Whether the person may sign in."""
    created_at: datetime
    """Time of creation, UTC."""
    has_password: bool
    """Whether a password was chosen already."""


@answer
@dataclass(frozen=True)
class Token:
    """Token that a program shows instead of a password."""

    id: int
    """Number of the token."""
    login: str
    """Account that it acts for."""
    label: str
    """Purpose of the token."""
    role: Role
    """Highest role of the token, which never has more than its account may."""
    created_at: datetime
    """Time of creation, UTC."""
    expires_at: datetime
    """Time until which it is valid, UTC."""
    revoked_at: datetime | None
    """Time of revocation, UTC."""
    last_used_at: datetime | None
    """Hour of the last use, UTC."""


@dataclass(frozen=True)
class Person:
    """Sender of a request."""

    login: str
    """Account; empty of somebody who did not sign in."""
    name: str
    """Name under the person's actions; empty where the person gives it in each request."""
    role: Role | None
    """Role; None for somebody who may only sign in."""
    token: str = ""
    """Label of the token that was shown; empty of a browser."""
    token_id: int | None = None
    """Number of the token; None of a browser."""
    csrf: str = ""
    """Secret that every form of a signed-in browser returns; empty of a program."""

    def may(self, needed: Role) -> bool:
        """Whether this person may do what a role may."""
        return self.role is not None and self.role.may(needed)

    def signs(self, said: str) -> str:
        """The name under what this person does: the account's, or, where nobody signs in, as they said."""
        return self.name or said

    @property
    def account(self) -> str:
        """Name in the audit trail: the account, and the token that acted for it."""
        return say("{login}, token {token}", login=self.login, token=self.token) if self.token else self.login


UNNAMED = "whoever is at this machine"
"""Name of the administrator where nobody needs to sign in."""
COMMAND_LINE = "command line"
"""Name in the audit trail of anybody with direct access to the database."""
STRANGER = Person("", "", None)
"""Somebody who has not signed in."""
LOOKING = Person("", "", Role.VIEWER)
"""Somebody who has not signed in where there is nothing but a demonstration to see."""
EVERYBODY = Person("", "", Role.ADMIN)
"""Person in place of everybody where nobody needs to sign in."""
