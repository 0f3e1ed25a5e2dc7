"""The pages of signing in, and of one's own account."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Annotated

from fastapi import APIRouter, Form, Path, Query, Request, Response
from fastapi.responses import HTMLResponse, RedirectResponse

from estimator.message import say
from service.errors import ForbiddenError, SignInError
from service.kit.person import Account, Role, Token
from service.people.admission import COOKIE, Gate, PersonOf, attempt_of, cookie_of, proof_for
from service.people.admission import LASTS as KNOWN
from service.people.changes import (
    LASTS,
    Chosen,
    attempting,
    change_password,
    link_of,
    make_token,
    require_may_revoke,
    require_no_token,
    revoke_token,
    sign_in,
    sign_out,
    use_link,
)
from service.people.dependencies import SEE_OTHER, Number, StorageOf
from service.people.secret import LONGEST, SHORTEST
from service.people.store import Accounts, Tokens
from service.settings import Settings
from service.web.application import application_of
from service.web.dependencies import Now, Reading, SettingsOf
from service.web.fields import NO_NUL
from service.web.render import render


@dataclass(frozen=True)
class SignInPage:
    """Login and password."""

    next: str
    """Where it leads, an address of this service."""
    wrong: str
    """What was wrong the last time; empty the first time."""
    provider: str
    """What the provider that people may sign in at is called; empty where none is set."""


@dataclass(frozen=True)
class LinkPage:
    """What somebody fills in who opened a link."""

    secret: str
    account: Account | None
    """None where the first account of all is made."""
    shortest: int
    """Characters of a password."""


@dataclass(frozen=True)
class TokenLine:
    """One token in words."""

    token: Token
    state: str
    holds: bool


@dataclass(frozen=True)
class AccountPage:
    """One's own account."""

    tokens: tuple[TokenLine, ...]
    secret: str
    """Of the token that was just made; empty otherwise."""
    roles: tuple[Role, ...]


def account_page(tokens: Sequence[Token], now: datetime, secret: str = "") -> AccountPage:
    """The page of an account's tokens."""
    return AccountPage(tuple(_line(token, now) for token in tokens), secret, tuple(Role))


def _line(token: Token, now: datetime) -> TokenLine:
    if token.revoked_at is not None:
        return TokenLine(token, say("revoked on {revoked_at}", revoked_at=f"{token.revoked_at:%Y-%m-%d}"), holds=False)
    if token.expires_at <= now:
        return TokenLine(token, say("expired on {expires_at}", expires_at=f"{token.expires_at:%Y-%m-%d}"), holds=False)
    used = (
        "never used"
        if token.last_used_at is None
        else say("last used on {last_used_at}", last_used_at=f"{token.last_used_at:%Y-%m-%d}")
    )
    return TokenLine(
        token,
        say("holds until {expires_at}, {last_use}", expires_at=f"{token.expires_at:%Y-%m-%d}", last_use=used),
        holds=True,
    )


router = APIRouter(include_in_schema=False, default_response_class=HTMLResponse)
Login = Annotated[str, Form(max_length=200, pattern=NO_NUL)]
Password = Annotated[str, Form(max_length=LONGEST, pattern=NO_NUL)]
Secret = Annotated[str, Path(max_length=100, pattern=r"^[A-Za-z0-9_-]+$")]
Label = Annotated[str, Form(min_length=1, max_length=200, pattern=NO_NUL)]


@router.get("/sign-in")
def show_sign_in(request: Request, next: Annotated[str, Query(max_length=2000)] = "/") -> HTMLResponse:
    """Login and password."""
    return render(request, "sign_in.html", SignInPage(inside(next), "", _provider(request)))


@router.post("/sign-in")
def take_sign_in(
    request: Request,
    login: Login,
    password: Password,
    storage: StorageOf,
    settings: SettingsOf,
    now: Now,
    next: Annotated[str, Form(max_length=2000)] = "/",
) -> Response:
    """Signs in, or says that it was wrong."""
    try:
        with attempting(storage, attempt_of(request, login), now):
            secret = sign_in(storage, login, password, now)
    except SignInError as wrong:
        return render(request, "sign_in.html", SignInPage(inside(next), wrong.detail, _provider(request)), wrong.status)
    return _known(signed_in(request, settings, secret, inside(next)), request, login)


@router.get("/sign-in/{secret}")
def show_link(request: Request, secret: Secret, storage: StorageOf, now: Now) -> HTMLResponse:
    """What somebody fills in who opened a link; looking at it does not use it up."""
    return render(request, "link.html", LinkPage(secret, link_of(storage, secret, now), SHORTEST))


@router.post("/sign-in/{secret}")
def take_link(
    request: Request,
    secret: Secret,
    password: Password,
    storage: StorageOf,
    settings: SettingsOf,
    now: Now,
    login: Login = "",
    name: Login = "",
) -> Response:
    """Sets the password and signs in."""
    owner = link_of(storage, secret, now)
    answer = signed_in(request, settings, use_link(storage, secret, Chosen(login, name, password), now), "/")
    return _known(answer, request, login if owner is None else owner.login)


@router.post("/sign-out")
def take_sign_out(request: Request, storage: StorageOf, now: Now) -> RedirectResponse:
    """The browser is nobody's any more."""
    sign_out(storage, request.cookies.get(COOKIE, ""), now)
    answer = RedirectResponse("/sign-in", SEE_OTHER)
    answer.delete_cookie(COOKIE)
    return answer


@router.get("/account")
def show_account(request: Request, store: Reading, person: PersonOf, now: Now) -> HTMLResponse:
    """One's own name, password and tokens."""
    return render(request, "account.html", account_page(Tokens(store).every(person.login) if person.login else (), now))


@router.post("/account/password")
def take_password(
    request: Request, old: Password, new: Password, storage: StorageOf, person: PersonOf, now: Now
) -> RedirectResponse:
    """Another password; browsers must sign in again, and tokens are revoked. Whoever found a browser open may not
    guess."""
    with attempting(storage, attempt_of(request, person.login), now):
        change_password(storage, person.login, old, new, now)
    return _known(RedirectResponse("/sign-in", SEE_OTHER), request, person.login)


@router.post("/account/tokens")
def take_token(
    request: Request,
    label: Label,
    role: Annotated[Role, Form()],
    days: Annotated[int, Form(ge=1, le=366)],
    storage: StorageOf,
    person: PersonOf,
    now: Now,
) -> HTMLResponse:
    """A new token; its secret is on this page and nowhere else."""
    require_no_token(person)
    if not person.login or not person.may(role):
        raise ForbiddenError(
            say("{account} cannot make a token for {role}.", account=person.account or "Nobody", role=role)
        )
    _, secret = make_token(storage, person.login, label, role, now, lasts=timedelta(days=days), who=person.name)
    with storage.database.reading() as store:
        return render(request, "account.html", account_page(Tokens(store).every(person.login), now, secret))


@router.post("/account/tokens/{id}/revoke")
def take_back(id: Number, storage: StorageOf, person: PersonOf, now: Now) -> RedirectResponse:
    """Nobody gets in with it any more."""
    with storage.database.reading() as store:
        require_may_revoke(person, Tokens(store).get(id))
    revoke_token(storage, id, now, who=person.signs("admin"))
    return RedirectResponse("/account", SEE_OTHER)


def _provider(request: Request) -> str:
    """What the provider that people may sign in at is called."""
    provider = application_of(request).part(Gate).provider
    return provider.name if provider else ""


def inside(address: str) -> str:
    """An address of this service; any other is the fleet's, so that no link to the sign-in leads elsewhere."""
    return address if address.startswith("/") and not address.startswith(("//", "/\\")) else "/"


def signed_in(request: Request, settings: Settings, secret: str, to: str) -> RedirectResponse:
    """The browser is somebody's from now on."""
    answer = RedirectResponse(to, SEE_OTHER)
    age = int(LASTS.total_seconds())
    answer.set_cookie(COOKIE, secret, max_age=age, httponly=True, samesite="lax", secure=is_secure(request, settings))
    return answer


def _known(answer: RedirectResponse, request: Request, login: str) -> RedirectResponse:
    """The browser has just shown the account's password: from now on its attempts are counted apart from others'."""
    own = application_of(request)
    with own.storage.database.reading() as store:
        stored = Accounts(store).password_hash(login.strip())
    if stored is not None:
        proof, age = proof_for(login, stored, own.clock()), int(KNOWN.total_seconds())
        secure = is_secure(request, own.settings)
        answer.set_cookie(cookie_of(login), proof, max_age=age, httponly=True, samesite="lax", secure=secure)
    return answer


def is_secure(request: Request, settings: Settings) -> bool:
    """Whether browsers reach the service by https, so that cookies need never go otherwise."""
    return request.url.scheme == "https" or settings.public_url.startswith("https:")
