"""Authentication and authorisation, once for every route, before its handler."""

import hmac
from datetime import datetime, timedelta
from hashlib import sha256
from ipaddress import IPv6Address, IPv6Network, ip_address
from secrets import token_urlsafe
from typing import Annotated, Any

from fastapi import Depends, Request
from starlette.datastructures import UploadFile

from estimator.message import say
from service.errors import ForbiddenError, SignInError
from service.ingest.apart import SENDER
from service.kit.person import EVERYBODY, LOOKING, RANKS, STRANGER, Person, Role
from service.people.access import METRICS, NEEDED, Route
from service.people.changes import SignInAttempt
from service.people.provider import Provider
from service.people.secret import csrf_of, is_same, stored_hash
from service.people.store import Accounts, SignIns, Tokens, is_stale
from service.sessions.store import Sessions
from service.settings import Settings
from service.storage import Storage
from service.web.application import application_of
from service.web.headers import API


class Gate:
    """Whether the service is open without accounts: on this machine alone, until the first account is made."""

    def __init__(self, settings: Settings, provider: Provider | None = None) -> None:
        self._settings, self._has_accounts = settings, False
        self.provider = provider
        """External sign-in provider."""

    @property
    def may_be_open(self) -> bool:
        """Whether the service can be open without signing in."""
        return self._settings.sign_in == "off" or (self._settings.sign_in == "auto" and self._settings.is_local)

    def is_open(self, storage: Storage) -> bool:
        """Queries the database until there is an account; accounts are never deleted."""
        if not self.may_be_open or self._settings.sign_in == "off":
            return self.may_be_open
        if not self._has_accounts:
            with storage.database.reading() as store:
                self._has_accounts = Accounts(store).any()
        return not self._has_accounts


SITE = 64
"""Prefix length of an IPv6 site: the customer chooses the other bits freely."""


def counted_address(client: str) -> str:
    """The client's address; of IPv6 the network of its site, of mapped IPv4 the IPv4 address."""
    try:
        address = ip_address(client)
    except ValueError:
        return client
    if not isinstance(address, IPv6Address):
        return client
    return str(address.ipv4_mapped or IPv6Network((address, SITE), strict=False))


PROOF_LIFETIME = timedelta(days=365)
"""Lifetime of a remembered browser since its last sign-in."""


def cookie_of(login: str) -> str:
    """Name of the cookie, one for each account: several people may use one browser."""
    return f"imu-health-known-{sha256(_plain(login).encode()).hexdigest()[:12]}"


def proof_for(login: str, password_hash: str, now: datetime) -> str:
    """Proof for a browser that has just shown the account's password."""
    payload = f"{token_urlsafe(12)}.{int((now + PROOF_LIFETIME).timestamp())}"
    return f"{payload}.{_sealed(login, password_hash, payload)}"


def browser_of(proof: str, login: str, password_hash: str | None, now: datetime) -> str:
    """The identifier of a browser; empty for an invalid proof, or one of another account or an earlier password."""
    payload, _, seal = proof.rpartition(".")
    browser, _, until = payload.partition(".")
    is_valid = is_same(seal, _sealed(login, password_hash or "", payload)) and password_hash is not None
    return browser if is_valid and int(until) > now.timestamp() else ""


def _sealed(login: str, password_hash: str, payload: str) -> str:
    key = hmac.digest(password_hash.encode(), b"known browsers of imu-health", sha256)
    return hmac.new(key, "\n".join((_plain(login), payload)).encode(), sha256).hexdigest()


def _plain(login: str) -> str:
    return login.strip().lower()


COOKIE = "imu-health"
"""Holds the secret of a signed-in browser."""
CSRF = "csrf"
"""Field of every form of a signed-in browser; scripts send the header."""
CSRF_HEADER = "X-CSRF-Token"
FORWARDED = ("forwarded", "x-forwarded-for", "x-forwarded-host", "x-forwarded-proto", "x-real-ip", "via")
"""Headers of requests forwarded by a proxy (RFC 7239, RFC 9110, and common usage)."""
SAFE = ("GET", "HEAD", "OPTIONS")
SIGN_IN_FIRST = "Sign in first, or send a token: `Authorization: Bearer …`."
BAD_TOKEN = "This token is not known, or it has expired or was revoked."
BAD_FORM = "This form is not of the page that you have open. Load the page again and send it once more."


def route_of(scope: Any) -> Route:
    """Method and path template of the route of a request."""
    path = getattr(scope.get("route"), "path", "")
    return scope["method"], f"{API}{path}" if scope["path"].startswith(f"{API}/") else path


def _person(request: Request) -> Person:
    """The sender of the request; an invalid token is an error, an invalid cookie is ignored."""
    person = STRANGER
    if NEEDED.get(route_of(request.scope)) is not None:
        person = _by_token(request) or _by_cookie(request) or _unknown(request)
    request.state.person = person
    return person


PersonOf = Annotated[Person, Depends(_person)]
"""The sender of the request."""


def _by_token(request: Request) -> Person | None:
    kind, _, secret = request.headers.get("authorization", "").partition(" ")
    if kind.lower() != "bearer":
        return None
    application = application_of(request)
    if (
        route_of(request.scope) == METRICS
        and application.settings.metrics_token
        and is_same(secret, application.settings.metrics_token)
    ):
        return Person("", "", Role.ADMIN, token="metrics")
    now = application.clock()
    with application.storage.database.reading() as store:
        found = Tokens(store).shown(stored_hash(secret.strip()), now)
    if found is None:
        raise SignInError(BAD_TOKEN)
    token, account = found
    if is_stale(token, now):
        with application.storage.database.writing() as store:
            Tokens(store).used(token.id, now)
    role = min(token.role, account.role, key=RANKS.__getitem__)
    return Person(account.login, account.name, role, token=token.label, token_id=token.id)


def _by_cookie(request: Request) -> Person | None:
    secret = request.cookies.get(COOKIE)
    if not secret:
        return None
    application = application_of(request)
    with application.storage.database.reading() as store:
        account = SignIns(store).shown(stored_hash(secret), application.clock())
    return None if account is None else Person(account.login, account.name, account.role, csrf=csrf_of(secret))


def _unknown(request: Request) -> Person:
    """A sender without credentials: everybody, where no accounts are needed; else a demonstration may be viewed."""
    application = application_of(request)
    if application.part(Gate).is_open(application.storage) and (
        application.settings.sign_in == "off" or not _was_forwarded(request)
    ):
        return EVERYBODY
    with application.storage.database.reading() as store:
        return LOOKING if Sessions(store).only_demonstration() else STRANGER


def _was_forwarded(request: Request) -> bool:
    """Whether a proxy on this machine forwards the request: then listening only locally protects nothing."""
    return any(name in request.headers for name in FORWARDED)


async def _admitted(request: Request, person: PersonOf) -> None:
    """Checks permission; a signed-in browser proves that the form is from this service."""
    route = route_of(request.scope)
    SENDER.set(person.login or (request.client.host if request.client else ""))
    if route not in NEEDED:
        raise ForbiddenError("Nobody may {method} {path}: it has no rule.", method=route[0], path=route[1])
    needed_role = NEEDED[route]
    if needed_role is None:
        return
    if not person.may(needed_role):
        raise ForbiddenError(_lacking(person, needed_role)) if person.login else SignInError(SIGN_IN_FIRST)
    if person.csrf and request.method not in SAFE and not is_same(await _proof(request), person.csrf):
        raise ForbiddenError(BAD_FORM)


def _lacking(person: Person, needed_role: Role) -> str:
    parts = {"needed_role": needed_role, "account": person.account, "role": person.role}
    return say("This needs the role {needed_role}; {account} is {role}. Ask an administrator.", **parts)


async def _proof(request: Request) -> str:
    """The CSRF token of a form or script; of an upload the header or the address, as its body is not read here."""
    token = request.headers.get(CSRF_HEADER) or request.query_params.get(CSRF)
    if token is None and request.headers.get("content-type", "").startswith("application/x-www-form-urlencoded"):
        field = (await request.form()).get(CSRF)
        token = None if isinstance(field, UploadFile) else field
    return token or ""


def attempt_of(request: Request, login: str) -> SignInAttempt:
    """An attempt at a password: its account, address, and browser if that has signed in there before."""
    application = application_of(request)
    peer = request.client.host if request.client else ""
    with application.storage.database.reading() as store:
        stored = Accounts(store).password_hash(login.strip())
    proof = request.cookies.get(cookie_of(login), "")
    browser = browser_of(proof, login, stored, application.clock()) if proof else ""
    return SignInAttempt(login, counted_address(peer), browser)


ADMITTED = [Depends(_admitted)]
"""Dependency of every router."""
