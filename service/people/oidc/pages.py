"""The way to the provider that people may sign in at, and back; closed where the operator has set no provider."""

from typing import Annotated
from urllib.parse import quote, unquote

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import RedirectResponse

from service.errors import NotFoundError, ServiceError, SignInError
from service.people.account_pages import SignInPage, inside, is_secure, signed_in
from service.people.admission import Gate
from service.people.dependencies import SEE_OTHER, StorageOf
from service.people.provider import Answer, Journey, Provider, joining_of
from service.people.secret import new_secret
from service.people.sign_in_elsewhere import sign_in_elsewhere
from service.settings import Settings
from service.web.application import application_of
from service.web.dependencies import Now, SettingsOf
from service.web.fields import NO_NUL
from service.web.render import render

router = APIRouter(include_in_schema=False)
COOKIE, PATH = "imu-health-oidc", "/oidc"
"""Holds the secret of a journey and where it leads; sent nowhere else."""
LASTS = 600
"""Seconds of a journey: somebody may have to find their second factor."""
NOT_SET = "Nobody signs in elsewhere here: no provider is set."
NOT_BEGUN = "This sign-in was not begun in this browser, or more than ten minutes ago. Try again."
DECLINED = "The provider did not sign you in. Try again, or ask an administrator."
Brought = Annotated[str, Query(max_length=4000, pattern=NO_NUL)]


@router.get("/oidc/start")
def start(
    request: Request, settings: SettingsOf, next: Annotated[str, Query(max_length=2000, pattern=NO_NUL)] = "/"
) -> RedirectResponse:
    """Sends the browser to the provider."""
    journey = Journey(new_secret())
    answer = RedirectResponse(_provider(request).address(journey, _back(request, settings)), SEE_OTHER)
    held = f"{journey.secret}.{quote(inside(next), safe='')}"
    secure = is_secure(request, settings)
    answer.set_cookie(COOKIE, held, max_age=LASTS, path=PATH, httponly=True, samesite="lax", secure=secure)
    return answer


@router.get("/oidc/callback")
def come_back(
    request: Request,
    storage: StorageOf,
    settings: SettingsOf,
    now: Now,
    *,
    code: Brought = "",
    state: Brought = "",
    iss: Annotated[str | None, Query(max_length=4000, pattern=NO_NUL)] = None,
) -> Response:
    """Signs in whom the provider names, or says why not."""
    provider = _provider(request)
    secret, _, next = request.cookies.get(COOKIE, "").partition(".")
    to = inside(unquote(next))
    try:
        found = _found(Answer(code, state, iss), secret)
        claims = provider.claims(found, Journey(secret), _back(request, settings), now)
        answer: Response = signed_in(
            request, settings, sign_in_elsewhere(storage, claims, joining_of(settings), now), to
        )
    except ServiceError as wrong:
        answer = render(request, "sign_in.html", SignInPage(to, wrong.detail, provider.name), wrong.status)
    answer.delete_cookie(COOKIE, path=PATH)
    return answer


def _found(answer: Answer, secret: str) -> Answer:
    """What came back, as far as it can be an answer at all."""
    if not secret:
        raise SignInError(NOT_BEGUN)
    if not answer.code:
        raise SignInError(DECLINED)
    return answer


def _provider(request: Request) -> Provider:
    provider = application_of(request).part(Gate).provider
    if provider is None:
        raise NotFoundError(NOT_SET)
    return provider


def _back(request: Request, settings: Settings) -> str:
    """Where the provider sends the browser: its operator has written this address down."""
    own = settings.public_url.rstrip("/") or str(request.base_url).rstrip("/")
    return f"{own}/oidc/callback"
