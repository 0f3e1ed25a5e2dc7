"""Signing in at an OpenID provider that the operator has set: what it tells of somebody, and what it is asked with.

The library that checks its tokens comes with ``pip install 'imu-health[oidc]'`` and is imported when a provider is set.
"""

import hmac
from base64 import urlsafe_b64encode
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from typing import Protocol
from urllib.parse import urlsplit

from estimator.message import say
from service.errors import ServiceError
from service.kit.person import Role
from service.settings import Settings

ROOM = "service.people.oidc.protocol"
WITHOUT = "A provider to sign in at is set, but a library is missing: {fault}. Run pip install 'imu-health[oidc]'."
EVERYBODY = "*"
"""Stands for every value of the claim, and for none."""
LOOPBACK = ("localhost", "127.0.0.1", "::1")
"""Where a provider may be asked without encryption: nobody listens in between."""


@dataclass(frozen=True)
class Journey:
    """One way to the provider and back. All of it follows from a secret that only this browser holds."""

    secret: str

    @property
    def state(self) -> str:
        """Brought back by the browser: the answer is to a question that this browser asked."""
        return self._part(b"state")

    @property
    def nonce(self) -> str:
        """Brought back in the token: it was made for this question."""
        return self._part(b"nonce")

    @property
    def verifier(self) -> str:
        """Shown with the code: nobody else can exchange it (RFC 7636)."""
        return self._part(b"verifier")

    @property
    def challenge(self) -> str:
        """The verifier's SHA-256, which the provider is told before."""
        return urlsafe_b64encode(sha256(self.verifier.encode()).digest()).rstrip(b"=").decode()

    def _part(self, purpose: bytes) -> str:
        return hmac.new(self.secret.encode(), purpose, sha256).hexdigest()


@dataclass(frozen=True)
class Claims:
    """What a provider says of somebody, checked."""

    issuer: str
    subject: str
    """By which the provider knows the person for good; names and addresses may change hands."""
    login: str
    name: str
    groups: tuple[str, ...]
    """Values of the claim that gives roles."""


@dataclass(frozen=True)
class Answer:
    """What the browser brought back."""

    code: str
    state: str
    issuer: str | None
    """Of newer providers (RFC 9207)."""


class Provider(Protocol):
    """Where somebody signs in."""

    name: str

    def address(self, journey: Journey, back: str) -> str:
        """To which the browser is sent; AwayError where the provider does not answer."""

    def claims(self, answer: Answer, journey: Journey, back: str, now: datetime) -> Claims:
        """Who it was; SignInError where what came back cannot be believed."""


@dataclass(frozen=True)
class ProviderSet:
    """The provider as the operator set it."""

    issuer: str
    client: str
    secret: str
    """Empty of a client that has none."""
    role_claim: str
    hosts: frozenset[str]
    """That it may name in its own description."""


@dataclass(frozen=True)
class Joining:
    """Who of those that the provider knows gets in, and as what."""

    everybody: Role | None
    """Of all whom the provider knows; None lets only those in who have a role, or an account already."""
    by_claim: bool
    """Whether the role is the provider's to say, at every sign-in."""
    roles: Mapping[str, Role]
    """By value of the claim."""

    def role_of(self, groups: tuple[str, ...]) -> Role | None:
        """The furthest-reaching role of somebody's groups."""
        given = [self.roles[group] for group in groups if group in self.roles]
        given += [] if self.everybody is None else [self.everybody]
        return max(given, key=list(Role).index, default=None)


def joining_of(settings: Settings) -> Joining:
    """As the operator set it."""
    roles = {value: Role(role) for value, role in settings.oidc_roles}
    return Joining(roles.get(EVERYBODY), bool(settings.oidc_role_claim), roles)


def provider_of(settings: Settings) -> Provider | None:
    """The provider; None where none is set, ServiceError where it cannot be used."""
    if not settings.oidc_issuer:
        return None
    parts = urlsplit(settings.oidc_issuer)
    if parts.scheme != "https" and parts.hostname not in LOOPBACK:
        raise ServiceError(
            say(
                "The provider to sign in at, {oidc_issuer}, must be reached by https.", oidc_issuer=settings.oidc_issuer
            )
        )
    if not settings.oidc_client_id:
        raise ServiceError("A provider to sign in at is set, but no IMU_HEALTH_OIDC_CLIENT_ID.")
    own = ProviderSet(
        issuer=settings.oidc_issuer,
        client=settings.oidc_client_id,
        secret=_read(settings.oidc_client_secret_file),
        role_claim=settings.oidc_role_claim,
        hosts=frozenset({parts.netloc, *settings.oidc_hosts}),
    )
    try:
        room = import_module(ROOM)
    except ModuleNotFoundError as fault:
        raise ServiceError(say(WITHOUT, fault=fault)) from fault
    made: Provider = room.OpenIdProvider(own, str(parts.hostname))
    return made


def _read(file: Path | None) -> str:
    try:
        return "" if file is None else file.read_text("utf-8").strip()
    except OSError as fault:
        raise ServiceError(
            say("The secret for the provider to sign in at cannot be read: {fault}.", fault=fault)
        ) from fault
