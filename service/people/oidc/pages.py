"""Redirects to the sign-in provider and back; closed where none is configured."""

from typing import Annotated
from urllib.parse import quote, unquote

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import RedirectResponse

from service.errors import NotFoundError, ServiceError, SignInError
from service.people.account_pages import SignInPage, is_secure, local_address, signed_in
from service.people.admission import Gate
from service.people.dependencies import SEE_OTHER, StorageOf
from service.people.provider import Callback, Journey, Provider, joining_of
from service.people.secret import new_secret
from service.people.sign_in_elsewhere import sign_in_elsewhere
from service.settings import Settings
from service.web.application import application_of
from service.web.dependencies import Now, SettingsOf
from service.web.render import render

router = APIRouter(include_in_schema=False)
COOKIE, PATH = "imu-health-oidc", "/oidc"
"""Holds the secret of a sign-in and its target; sent nowhere else."""
LIFETIME_SECONDS = 600
"""Seconds for a sign-in: a second factor may be needed."""
NOT_SET = "No sign-in provider is set."
NOT_BEGUN = "This sign-in was not begun in this browser, or more than ten minutes ago. Try again."
DECLINED = "The provider did not sign you in. Try again, or ask an administrator."
CallbackText = Annotated[str, Query(max_length=4000)]


@router.get("/oidc/start")
def start(
    request: Request, settings: SettingsOf, next: Annotated[str, Query(max_length=2000)] = "/"
) -> RedirectResponse:
    """Sends the browser to the provider."""
    journey = Journey(new_secret())
    answer = RedirectResponse(_provider(request).address(journey, _back(request, settings)), SEE_OTHER)
    cookie = f"{journey.secret}.{quote(local_address(next), safe='')}"
    secure = is_secure(request, settings)
    answer.set_cookie(COOKIE, cookie, max_age=LIFETIME_SECONDS, path=PATH, httponly=True, samesite="lax", secure=secure)
    return answer


@router.get("/oidc/callback")
def come_back(
    request: Request,
    storage: StorageOf,
    settings: SettingsOf,
    now: Now,
    *,
    code: CallbackText = "",
    state: CallbackText = "",
    iss: Annotated[str | None, Query(max_length=4000)] = None,
) -> Response:
    """Signs the person in, or shows the error."""
    provider = _provider(request)
    secret, _, next = request.cookies.get(COOKIE, "").partition(".")
    to = local_address(unquote(next))
    try:
        callback = _valid(Callback(code, state, iss), secret)
        claims = provider.claims(callback, Journey(secret), _back(request, settings), now)
        answer: Response = signed_in(
            request, settings, sign_in_elsewhere(storage, claims, joining_of(settings), now), to
        )
    except ServiceError as fault:
        answer = render(request, "sign_in.html", SignInPage(to, fault.detail, provider.name), fault.status)
    answer.delete_cookie(COOKIE, path=PATH)
    return answer


def _valid(answer: Callback, secret: str) -> Callback:
    """The answer, if it can be valid at all."""
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
    """Redirect address, as registered at the provider."""
    base = settings.public_url.rstrip("/") or str(request.base_url).rstrip("/")
    return f"{base}/oidc/callback"
