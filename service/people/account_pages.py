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
from service.people.admission import COOKIE, PROOF_LIFETIME, Gate, PersonOf, attempt_of, cookie_of, proof_for
from service.people.changes import (
    SIGN_IN_LIFETIME,
    LinkForm,
    attempting,
    change_password,
    link_of,
    make_token,
    require_no_token,
    revoke_token,
    sign_in,
    sign_out,
    use_link,
)
from service.people.dependencies import SEE_OTHER, FormName, FormText, Number, PasswordTurn, StorageOf
from service.people.secret import LONGEST, SHORTEST
from service.people.store import Accounts, Tokens
from service.settings import Settings
from service.web.application import application_of
from service.web.dependencies import Now, Reading, SettingsOf
from service.web.fields import Sought
from service.web.render import render


@dataclass(frozen=True)
class SignInPage:
    """Login and password."""

    next: str
    """Address of this service to which it leads."""
    wrong: str
    """Error of the last attempt; empty the first time."""
    provider: str
    """Name of the sign-in provider; empty where none is configured."""


@dataclass(frozen=True)
class LinkPage:
    """The form behind a sign-in link."""

    secret: str
    account: Account | None
    """Account of the link; None where the first account is made."""
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
    """Secret of the token that was just made; empty otherwise."""
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
Login = Annotated[Sought, Form()]
Password = Annotated[str, Form(max_length=LONGEST)]
Secret = Annotated[str, Path(max_length=100, pattern=r"^[A-Za-z0-9_-]+$")]


@router.get("/sign-in")
def show_sign_in(request: Request, next: Annotated[str, Query(max_length=2000)] = "/") -> HTMLResponse:
    """Login and password."""
    return render(request, "sign_in.html", SignInPage(local_address(next), "", _provider(request)))


@router.post("/sign-in")
def take_sign_in(
    request: Request,
    login: Login,
    password: Password,
    _: PasswordTurn,
    storage: StorageOf,
    settings: SettingsOf,
    now: Now,
    next: Annotated[str, Form(max_length=2000)] = "/",
) -> Response:
    """Signs in, or shows the error."""
    try:
        with attempting(storage, attempt_of(request, login), now):
            secret = sign_in(storage, login, password, now)
    except SignInError as fault:
        return render(
            request, "sign_in.html", SignInPage(local_address(next), fault.detail, _provider(request)), fault.status
        )
    return _remembered(signed_in(request, settings, secret, local_address(next)), request, login)


@router.get("/sign-in/{secret}")
def show_link(request: Request, secret: Secret, storage: StorageOf, now: Now) -> HTMLResponse:
    """The form behind a sign-in link; showing it does not use the link."""
    return render(request, "link.html", LinkPage(secret, link_of(storage, secret, now), SHORTEST))


@router.post("/sign-in/{secret}")
def take_link(
    request: Request,
    secret: Secret,
    password: Password,
    _: PasswordTurn,
    storage: StorageOf,
    settings: SettingsOf,
    now: Now,
    login: Login = "",
    name: FormText = "",
) -> Response:
    """Sets the password and signs in."""
    owner = link_of(storage, secret, now)
    answer = signed_in(request, settings, use_link(storage, secret, LinkForm(login, name, password), now), "/")
    return _remembered(answer, request, login if owner is None else owner.login)


@router.post("/sign-out")
def take_sign_out(request: Request, storage: StorageOf, now: Now) -> RedirectResponse:
    """Signs the browser out."""
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
    request: Request, old: Password, new: Password, _: PasswordTurn, storage: StorageOf, person: PersonOf, now: Now
) -> RedirectResponse:
    """Changes the password; browsers must sign in again, and tokens are revoked. Guessing in an open browser is limited
    too."""
    with attempting(storage, attempt_of(request, person.login), now):
        change_password(storage, person.login, old, new, now)
    return _remembered(RedirectResponse("/sign-in", SEE_OTHER), request, person.login)


@router.post("/account/tokens")
def take_token(
    request: Request,
    label: FormName,
    role: Annotated[Role, Form()],
    days: Annotated[int, Form(ge=1, le=366)],
    storage: StorageOf,
    person: PersonOf,
    now: Now,
) -> HTMLResponse:
    """A new token; its secret is on this page and nowhere else."""
    require_no_token(person)
    if not person.login or not person.may(role):
        raise ForbiddenError("{account} cannot make a token for {role}.", account=person.account or "Nobody", role=role)
    _, secret = make_token(storage, person.login, label, role, now, lifetime=timedelta(days=days), who=person.name)
    with storage.database.reading() as store:
        return render(request, "account.html", account_page(Tokens(store).every(person.login), now, secret))


@router.post("/account/tokens/{id}/revoke")
def take_back(id: Number, storage: StorageOf, person: PersonOf, now: Now) -> RedirectResponse:
    """Revokes a token."""
    revoke_token(storage, id, person, now, who=person.signs("admin"))
    return RedirectResponse("/account", SEE_OTHER)


def _provider(request: Request) -> str:
    provider = application_of(request).part(Gate).provider
    return provider.name if provider else ""


def local_address(address: str) -> str:
    """An address of this service; the fleet's for any other, so that no sign-in link leads elsewhere."""
    return address if address.startswith("/") and not address.startswith(("//", "/\\")) else "/"


def signed_in(request: Request, settings: Settings, secret: str, to: str) -> RedirectResponse:
    """Signs the browser in."""
    answer = RedirectResponse(to, SEE_OTHER)
    age = int(SIGN_IN_LIFETIME.total_seconds())
    answer.set_cookie(COOKIE, secret, max_age=age, httponly=True, samesite="lax", secure=is_secure(request, settings))
    return answer


def _remembered(answer: RedirectResponse, request: Request, login: str) -> RedirectResponse:
    """The browser has just shown the account's password: from now on its attempts are counted separately."""
    application = application_of(request)
    with application.storage.database.reading() as store:
        stored = Accounts(store).password_hash(login.strip())
    if stored is not None:
        proof, age = proof_for(login, stored, application.clock()), int(PROOF_LIFETIME.total_seconds())
        secure = is_secure(request, application.settings)
        answer.set_cookie(cookie_of(login), proof, max_age=age, httponly=True, samesite="lax", secure=secure)
    return answer


def is_secure(request: Request, settings: Settings) -> bool:
    """Whether browsers reach the service by https, so that cookies need never be sent otherwise."""
    return request.url.scheme == "https" or settings.public_url.startswith("https:")
