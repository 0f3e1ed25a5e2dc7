"""Signing in at an OpenID provider that the operator has configured: requests, answers and claims.

The library that checks its tokens comes with ``pip install 'imu-health[oidc]'`` and is imported when a provider is
configured.
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
from service.kit.text import OF_A_LINE, fault_of_text
from service.settings import Settings

MODULE = "service.people.oidc.protocol"
WITHOUT = "A sign-in provider is set, but a library is missing: {fault}. Run pip install 'imu-health[oidc]'."
EVERYBODY = "*"
"""Stands for every value of the claim, and for none."""
LOOPBACK = ("localhost", "127.0.0.1", "::1")
"""Hosts of a provider that may be used without encryption: nobody can listen in between."""


@dataclass(frozen=True)
class Journey:
    """One sign-in at the provider. All of it is derived from a secret held by this browser only."""

    secret: str

    @property
    def state(self) -> str:
        """Returned by the browser: the answer is to a request of this browser."""
        return self._part(b"state")

    @property
    def nonce(self) -> str:
        """Returned in the token: it was made for this request."""
        return self._part(b"nonce")

    @property
    def verifier(self) -> str:
        """Secret sent with the code: nobody else can exchange it (RFC 7636)."""
        return self._part(b"verifier")

    @property
    def challenge(self) -> str:
        """The verifier's SHA-256, sent to the provider first."""
        return urlsafe_b64encode(sha256(self.verifier.encode()).digest()).rstrip(b"=").decode()

    def _part(self, purpose: bytes) -> str:
        return hmac.new(self.secret.encode(), purpose, sha256).hexdigest()


LONGEST_SUBJECT = 255
"""Characters (OpenID Connect Core 1.0, section 2)."""


def fault_of_subject(subject: str) -> str | None:
    """The fault of a person's identifier at the provider; None where it has none."""
    if len(subject) > LONGEST_SUBJECT:
        return say("is longer than {longest} characters", longest=LONGEST_SUBJECT)
    return fault_of_text(subject, OF_A_LINE, is_required=True)


@dataclass(frozen=True)
class Claims:
    """Checked claims of a provider about a person."""

    issuer: str
    subject: str
    """Permanent identifier of the person at the provider; names and addresses may change hands."""
    login: str
    name: str
    groups: tuple[str, ...]
    """Values of the claim for roles."""


@dataclass(frozen=True)
class Callback:
    """Parameters of the callback."""

    code: str
    state: str
    issuer: str | None
    """Issuer, from newer providers (RFC 9207)."""


class Provider(Protocol):
    """A sign-in provider."""

    name: str

    def address(self, journey: Journey, back: str) -> str:
        """Address of the sign-in page; AwayError where the provider does not answer."""

    def claims(self, answer: Callback, journey: Journey, back: str, now: datetime) -> Claims:
        """The person's claims; SignInError for an invalid answer."""


@dataclass(frozen=True)
class ProviderSettings:
    """Configuration of the provider."""

    issuer: str
    client: str
    secret: str
    """Secret of the client; empty for a public client."""
    role_claim: str
    hosts: frozenset[str]
    """Allowed in its metadata."""


@dataclass(frozen=True)
class Joining:
    """Rules by which people join from the provider, and their roles."""

    everybody: Role | None
    """Role of everybody at the provider; None admits only people with a role or an existing account."""
    by_claim: bool
    """Whether the provider decides the role, at every sign-in."""
    roles: Mapping[str, Role]
    """Roles by value of the claim."""

    def role_of(self, groups: tuple[str, ...]) -> Role | None:
        """The highest role of a person's groups."""
        roles = [self.roles[group] for group in groups if group in self.roles]
        roles += [] if self.everybody is None else [self.everybody]
        return max(roles, key=list(Role).index, default=None)


def joining_of(settings: Settings) -> Joining:
    """The rules of joining in the settings."""
    roles = {value: Role(role) for value, role in settings.oidc_roles}
    return Joining(roles.get(EVERYBODY), bool(settings.oidc_role_claim), roles)


def provider_of(settings: Settings) -> Provider | None:
    """The provider; None where none is configured, ServiceError for an invalid configuration."""
    if not settings.oidc_issuer:
        return None
    parts = urlsplit(settings.oidc_issuer)
    if parts.scheme != "https" and parts.hostname not in LOOPBACK:
        raise ServiceError(
            "The sign-in provider, {oidc_issuer}, must be reached by https.", oidc_issuer=settings.oidc_issuer
        )
    if not settings.oidc_client_id:
        raise ServiceError("A sign-in provider is set, but no IMU_HEALTH_OIDC_CLIENT_ID.")
    provider_settings = ProviderSettings(
        issuer=settings.oidc_issuer,
        client=settings.oidc_client_id,
        secret=_read(settings.oidc_client_secret_file),
        role_claim=settings.oidc_role_claim,
        hosts=frozenset({parts.netloc, *settings.oidc_hosts}),
    )
    try:
        module = import_module(MODULE)
    except ModuleNotFoundError as fault:
        raise ServiceError(WITHOUT, fault=fault) from fault
    provider: Provider = module.OpenIdProvider(provider_settings, str(parts.hostname))
    return provider


def _read(file: Path | None) -> str:
    try:
        return "" if file is None else file.read_text("utf-8").strip()
    except OSError as fault:
        raise ServiceError("The secret for the sign-in provider cannot be read: {fault}.", fault=fault) from fault
