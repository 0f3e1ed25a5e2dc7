"""Who sends a request, and whether they may: asked once for every route, before anything of it is done."""

from typing import Annotated, Any

from fastapi import Depends, Request
from starlette.datastructures import UploadFile

from estimator.message import say
from service.errors import ForbiddenError, SignInError
from service.ingest.sender import SENDER
from service.kit.person import EVERYBODY, LOOKING, RANKS, STRANGER, Person, Role
from service.people.access import METRICS, NEEDED, Route
from service.people.changes import Attempt
from service.people.client_address import counted_address
from service.people.gate import Gate
from service.people.known_browser import browser_of, cookie_of
from service.people.secret import csrf_of, is_same, stored_hash
from service.people.store import Accounts, SignIns, Tokens, is_stale
from service.sessions.store import Sessions
from service.web.application import application_of
from service.web.prefix import API

COOKIE = "imu-health"
"""Holds the secret of a signed-in browser."""
CSRF = "csrf"
"""Field of every form that a signed-in browser sends; scripts send the header."""
CSRF_HEADER = "X-CSRF-Token"
FORWARDED = ("forwarded", "x-forwarded-for", "x-forwarded-host", "x-forwarded-proto", "x-real-ip", "via")
"""Headers of requests that a proxy hands on (RFC 7239, RFC 9110, and what is usual)."""
SAFE = ("GET", "HEAD", "OPTIONS")
SIGN_IN_FIRST = "Sign in first, or send a token: `Authorization: Bearer …`."
BAD_TOKEN = "This token is not known, or it has expired or was revoked."
BAD_FORM = "This form is not of the page that you have open. Load the page again and send it once more."


def route_of(scope: Any) -> Route:
    """Method and path of the route that takes a request, with names for what stands in it."""
    path = getattr(scope.get("route"), "path", "")
    return scope["method"], f"{API}{path}" if scope["path"].startswith(f"{API}/") else path


def _person(request: Request) -> Person:
    """Who sends the request; a token that is none is an error, a cookie that is none is nobody."""
    person = STRANGER
    if NEEDED.get(route_of(request.scope)) is not None:
        person = _by_token(request) or _by_cookie(request) or _unknown(request)
    request.state.person = person
    return person


PersonOf = Annotated[Person, Depends(_person)]
"""Who sends the request."""


def _by_token(request: Request) -> Person | None:
    kind, _, secret = request.headers.get("authorization", "").partition(" ")
    if kind.lower() != "bearer":
        return None
    own = application_of(request)
    if (
        route_of(request.scope) == METRICS
        and own.settings.metrics_token
        and is_same(secret, own.settings.metrics_token)
    ):
        return Person("", "", Role.ADMIN, token="metrics")
    now = own.clock()
    with own.storage.database.reading() as store:
        shown = Tokens(store).shown(stored_hash(secret.strip()), now)
    if shown is None:
        raise SignInError(BAD_TOKEN)
    token, account = shown
    if is_stale(token, now):
        with own.storage.database.writing() as store:
            Tokens(store).used(token.id, now)
    role = min(token.role, account.role, key=RANKS.__getitem__)
    return Person(account.login, account.name, role, token=token.label, token_id=token.id)


def _by_cookie(request: Request) -> Person | None:
    secret = request.cookies.get(COOKIE)
    if not secret:
        return None
    own = application_of(request)
    with own.storage.database.reading() as store:
        account = SignIns(store).shown(stored_hash(secret), own.clock())
    return None if account is None else Person(account.login, account.name, account.role, csrf=csrf_of(secret))


def _unknown(request: Request) -> Person:
    """Somebody who shows nothing: everybody, where nobody needs to sign in; else a demonstration may be looked at."""
    own = application_of(request)
    if own.part(Gate).is_open(own.storage) and (own.settings.sign_in == "off" or not _was_forwarded(request)):
        return EVERYBODY
    with own.storage.database.reading() as store:
        return LOOKING if Sessions(store).only_demonstration() else STRANGER


def _was_forwarded(request: Request) -> bool:
    """Whether a proxy on this machine says that somebody else asks: then to listen here only keeps nobody out."""
    return any(name in request.headers for name in FORWARDED)


async def _admitted(request: Request, person: PersonOf) -> None:
    """Whether this person may; a signed-in browser proves that the form is ours."""
    route = route_of(request.scope)
    SENDER.set(person.login or (request.client.host if request.client else ""))
    if route not in NEEDED:
        raise ForbiddenError(say("Nobody may {route} {route2}: it has no rule.", route=route[0], route2=route[1]))
    needed = NEEDED[route]
    if needed is None:
        return
    if not person.may(needed):
        raise ForbiddenError(_lacking(person, needed)) if person.login else SignInError(SIGN_IN_FIRST)
    if person.csrf and request.method not in SAFE and not is_same(await _proof(request), person.csrf):
        raise ForbiddenError(BAD_FORM)


def _lacking(person: Person, needed: Role) -> str:
    return say(
        "This needs the role {needed}; {account} is {role}. Ask an administrator.",
        needed=needed,
        account=person.account,
        role=person.role,
    )


async def _proof(request: Request) -> str:
    """What a form or a script brings back; of an upload the header or the address, for its body is not read here."""
    shown = request.headers.get(CSRF_HEADER) or request.query_params.get(CSRF)
    if shown is None and request.headers.get("content-type", "").startswith("application/x-www-form-urlencoded"):
        field = (await request.form()).get(CSRF)
        shown = None if isinstance(field, UploadFile) else field
    return shown or ""


def attempt_of(request: Request, login: str) -> Attempt:
    """Who tries a password: at which account, from where, and with which browser if that has signed in there before."""
    own = application_of(request)
    peer = request.client.host if request.client else ""
    with own.storage.database.reading() as store:
        stored = Accounts(store).password_hash(login.strip())
    proof = request.cookies.get(cookie_of(login), "")
    browser = browser_of(proof, login, stored, own.clock()) if proof else ""
    return Attempt(login, counted_address(peer), browser)


ADMITTED = [Depends(_admitted)]
"""What every router asks first."""
