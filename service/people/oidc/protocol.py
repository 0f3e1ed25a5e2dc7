"""OpenID Connect Core 1.0, the authorization code flow with PKCE (RFC 7636) and RFC 9207.

The provider's metadata and keys are fetched at every sign-in: sign-ins are few, and a revoked key opens nothing. Its
addresses must be at allowed hosts; no redirect is followed, no proxy used.
"""

from collections.abc import Mapping
from datetime import datetime
from typing import Any
from urllib.parse import quote, urlencode, urlsplit

import httpx
from joserfc import jwt
from joserfc.errors import JoseError
from joserfc.jwk import KeySet

from estimator.json_object import Json
from estimator.message import say
from service.errors import AwayError, SignInError
from service.kit.log import log
from service.kit.text import in_one_line
from service.people.provider import Callback, Claims, Journey, ProviderSettings, fault_of_subject
from service.people.secret import is_same

ALGORITHMS = ("RS256", "PS256", "ES256", "RS384", "RS512", "ES384", "EdDSA")
"""Signatures with a public key; never `none`, never a shared key."""
SCOPE = "openid profile email"
TIMEOUT = httpx.Timeout(5.0)
"""Timeout, seconds: a person is waiting."""
MOST_BYTES = 256 * 1024
"""Most bytes of an answer: metadata, a set of keys, a token."""
LEEWAY = 60
"""Seconds by which clocks may differ."""
SILENT = "The sign-in provider does not answer as it should; try again, or sign in with a password."
REFUSED = "The sign-in was not accepted: {why}. Try again, or ask an administrator."
WELL_KNOWN = "/.well-known/openid-configuration"


class OpenIdProvider:
    """A sign-in provider."""

    def __init__(self, settings: ProviderSettings, name: str) -> None:
        self._own, self.name = settings, name

    def address(self, journey: Journey, back: str) -> str:
        """Address of the sign-in page."""
        with _http() as http:
            metadata = self._metadata(http)
        parameters = {
            "response_type": "code",
            "client_id": self._own.client,
            "redirect_uri": back,
            "scope": SCOPE,
            "state": journey.state,
            "nonce": journey.nonce,
            "code_challenge": journey.challenge,
            "code_challenge_method": "S256",
        }
        endpoint = self._allowed(metadata, "authorization_endpoint")
        return f"{endpoint}{'&' if urlsplit(endpoint).query else '?'}{urlencode(parameters)}"

    def claims(self, answer: Callback, journey: Journey, back: str, now: datetime) -> Claims:
        """The person's claims; SignInError for an invalid answer."""
        if not is_same(answer.state, journey.state):
            raise _refused("it was not asked for by this browser")
        with _http() as http:
            metadata = self._metadata(http)
            self._require_issuer(answer, metadata)
            token = self._exchanged(http, self._allowed(metadata, "token_endpoint"), answer.code, journey, back)
            keys = _json(http, "GET", self._allowed(metadata, "jwks_uri"))
        return self._checked(token, keys, journey, now)

    def _metadata(self, http: httpx.Client) -> Json:
        """The provider's metadata; it must be of the configured issuer."""
        metadata = _json(http, "GET", self._own.issuer.rstrip("/") + WELL_KNOWN)
        if metadata.get("issuer") != self._own.issuer:
            raise _unavailable(
                say("its description names the issuer {described}", described=repr(metadata.get("issuer")))
            )
        return metadata

    def _allowed(self, metadata: Mapping[str, Any], name: str) -> str:
        """An address in the metadata, at an allowed host, as well encrypted as the issuer."""
        address = str(metadata.get(name, ""))
        parts = urlsplit(address)
        if parts.scheme != urlsplit(self._own.issuer).scheme or parts.netloc not in self._own.hosts:
            raise _unavailable(
                say(
                    "its {name} {address} is at a host that is not allowed, or not by https",
                    name=name,
                    address=repr(address),
                )
            )
        return address

    def _require_issuer(self, answer: Callback, metadata: Mapping[str, Any]) -> None:
        is_required = metadata.get("authorization_response_iss_parameter_supported") is True
        if answer.issuer != self._own.issuer and (is_required or answer.issuer is not None):
            raise _refused("it came from another provider")

    def _exchanged(self, http: httpx.Client, endpoint: str, code: str, journey: Journey, back: str) -> str:
        """The token for a code, which works once."""
        settings = self._own
        form = {
            "grant_type": "authorization_code",
            "code": code,
            "redirect_uri": back,
            "code_verifier": journey.verifier,
        }
        credentials = (quote(settings.client, safe=""), quote(settings.secret, safe="")) if settings.secret else None
        if credentials is None:
            form["client_id"] = settings.client
        token = _json(http, "POST", endpoint, data=form, auth=credentials).get("id_token")
        if not isinstance(token, str):
            raise _refused("the provider gave no token")
        return token

    def _checked(self, token: str, keys: Any, journey: Journey, now: datetime) -> Claims:
        """The claims of a token that is signed by this provider, for this service and sign-in, and valid now."""
        try:
            claims = jwt.decode(token, KeySet.import_key_set(keys), algorithms=list(ALGORITHMS)).claims
            self._registry(now).validate(claims)
        except (JoseError, ValueError, TypeError, KeyError) as fault:
            log.warning("sign-in elsewhere refused", fault=f"{type(fault).__name__}: {fault}")
            raise _refused("its token is not valid") from fault
        self._require_ours(claims, journey)
        groups = claims.get(self._own.role_claim, ()) if self._own.role_claim else ()
        groups = (groups,) if isinstance(groups, str) else groups
        return Claims(
            issuer=self._own.issuer,
            subject=claims["sub"],
            login=_text(claims, "preferred_username") or _text(claims, "email") or claims["sub"],
            name=_text(claims, "name"),
            groups=tuple(g for g in groups if isinstance(g, str)) if isinstance(groups, list | tuple) else (),
        )

    def _registry(self, now: datetime) -> jwt.JWTClaimsRegistry:
        return jwt.JWTClaimsRegistry(
            int(now.timestamp()),
            LEEWAY,
            iss={"essential": True, "value": self._own.issuer},
            aud={"essential": True, "value": self._own.client},
            sub={"essential": True},
            exp={"essential": True},
            iat={"essential": True},
            nonce={"essential": True},
        )

    def _require_ours(self, claims: Mapping[str, Any], journey: Journey) -> None:
        has_other_audiences = isinstance(claims["aud"], list) and len(claims["aud"]) > 1
        if claims.get("azp", None if has_other_audiences else self._own.client) != self._own.client:
            raise _refused("its token was made for another program")
        if not is_same(str(claims["nonce"]), journey.nonce):
            raise _refused("its token was made for another sign-in")
        if fault_of_subject(claims["sub"]):
            raise _refused("its token names nobody")


def _http() -> httpx.Client:
    return httpx.Client(timeout=TIMEOUT, follow_redirects=False, trust_env=False)


def _json(http: httpx.Client, method: str, address: str, **sent: Any) -> Json:
    """A JSON object of the provider; AwayError for any other answer."""
    try:
        with http.stream(method, address, headers={"Accept": "application/json"}, **sent) as answer:
            body = _bounded(answer)
            if answer.status_code in (400, 401) and method == "POST":
                log.warning("sign-in elsewhere refused", fault=body[:500].decode("utf-8", "replace"))
                raise _refused("the provider takes the code for used or foreign")
            if answer.status_code != httpx.codes.OK:
                raise _unavailable(
                    say("{address} answered {status_code}", address=address, status_code=answer.status_code)
                )
            document = httpx.Response(200, content=body).json()
    except (httpx.HTTPError, ValueError) as fault:
        raise _unavailable(f"{address}: {type(fault).__name__}: {fault}") from fault
    if not isinstance(document, dict):
        raise _unavailable(say("{address} answered no object", address=address))
    return document


def _bounded(answer: httpx.Response) -> bytes:
    body = bytearray()
    for part in answer.iter_bytes():
        body += part
        if len(body) > MOST_BYTES:
            raise _unavailable(say("{url} answers without end", url=answer.url))
    return bytes(body)


def _text(claims: Mapping[str, Any], name: str) -> str:
    """A claim as text; empty for anything else."""
    value = claims.get(name)
    return in_one_line(value)[:200] if isinstance(value, str) else ""


def _refused(why: str) -> SignInError:
    return SignInError(REFUSED, why=why)


def _unavailable(fault: str) -> AwayError:
    """The fault is in the log, for the operator."""
    log.warning("provider to sign in at", fault=fault)
    return AwayError(SILENT)
