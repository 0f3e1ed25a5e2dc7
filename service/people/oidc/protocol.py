"""OpenID Connect Core 1.0, the authorization code flow with PKCE (RFC 7636) and RFC 9207.

The provider is asked for its description and its keys at every sign-in: they are few, and a key that it took back opens
nothing. Its addresses must be at hosts that the operator knows; no redirect is followed, no proxy used.
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
from service.people.provider import Answer, Claims, Journey, ProviderSet
from service.people.secret import is_same

ALGORITHMS = ("RS256", "PS256", "ES256", "RS384", "RS512", "ES384", "EdDSA")
"""Signatures with a public key; never `none`, never a key that both sides share."""
SCOPE = "openid profile email"
TIMEOUT = httpx.Timeout(5.0)
"""Seconds: somebody is waiting in front of a browser."""
MOST_BYTES = 256 * 1024
"""Of an answer: a description, a set of keys, a token."""
LEEWAY = 60
"""Seconds by which clocks may differ."""
LONGEST_SUBJECT = 255
"""Characters (OpenID Connect Core 1.0, section 2)."""
SILENT = "The provider to sign in at does not answer as it should; try again, or sign in with a password."
REFUSED = "The sign-in was not accepted: {why}. Try again, or ask an administrator."
WELL_KNOWN = "/.well-known/openid-configuration"


class OpenIdProvider:
    """Where somebody signs in."""

    def __init__(self, own: ProviderSet, name: str) -> None:
        self._own, self.name = own, name

    def address(self, journey: Journey, back: str) -> str:
        """To which the browser is sent."""
        with _http() as http:
            described = self._described(http)
        asked = {
            "response_type": "code",
            "client_id": self._own.client,
            "redirect_uri": back,
            "scope": SCOPE,
            "state": journey.state,
            "nonce": journey.nonce,
            "code_challenge": journey.challenge,
            "code_challenge_method": "S256",
        }
        at = self._allowed(described, "authorization_endpoint")
        return f"{at}{'&' if urlsplit(at).query else '?'}{urlencode(asked)}"

    def claims(self, answer: Answer, journey: Journey, back: str, now: datetime) -> Claims:
        """Who it was; SignInError where what came back cannot be believed."""
        if not is_same(answer.state, journey.state):
            raise _refused("it was not asked for by this browser")
        with _http() as http:
            described = self._described(http)
            self._require_issuer(answer, described)
            token = self._exchanged(http, self._allowed(described, "token_endpoint"), answer.code, journey, back)
            keys = _json(http, "GET", self._allowed(described, "jwks_uri"))
        return self._checked(token, keys, journey, now)

    def _described(self, http: httpx.Client) -> Json:
        """The provider's own description; it must be of the issuer that was asked."""
        described = _json(http, "GET", self._own.issuer.rstrip("/") + WELL_KNOWN)
        if described.get("issuer") != self._own.issuer:
            raise _away(say("its description names the issuer {described}", described=repr(described.get("issuer"))))
        return described

    def _allowed(self, described: Mapping[str, Any], name: str) -> str:
        """An address of the description, at a host that the operator knows, as well encrypted as the issuer."""
        address = str(described.get(name, ""))
        parts = urlsplit(address)
        if parts.scheme != urlsplit(self._own.issuer).scheme or parts.netloc not in self._own.hosts:
            raise _away(
                say(
                    "its {name} {address} is at a host that is not allowed, or not by https",
                    name=name,
                    address=repr(address),
                )
            )
        return address

    def _require_issuer(self, answer: Answer, described: Mapping[str, Any]) -> None:
        """That no other provider's answer is taken for this one's."""
        needed = described.get("authorization_response_iss_parameter_supported") is True
        if answer.issuer != self._own.issuer and (needed or answer.issuer is not None):
            raise _refused("it came from another provider")

    def _exchanged(self, http: httpx.Client, at: str, code: str, journey: Journey, back: str) -> str:
        """The token for a code, which works once."""
        own = self._own
        sent = {
            "grant_type": "authorization_code",
            "code": code,
            "redirect_uri": back,
            "code_verifier": journey.verifier,
        }
        shown = (quote(own.client, safe=""), quote(own.secret, safe="")) if own.secret else None
        if shown is None:
            sent["client_id"] = own.client
        token = _json(http, "POST", at, data=sent, auth=shown).get("id_token")
        if not isinstance(token, str):
            raise _refused("the provider gave no token")
        return token

    def _checked(self, token: str, keys: Any, journey: Journey, now: datetime) -> Claims:
        """The claims of a token that this provider signed, for us, for this question, and that holds now."""
        try:
            found = jwt.decode(token, KeySet.import_key_set(keys), algorithms=list(ALGORITHMS)).claims
            self._registry(now).validate(found)
        except (JoseError, ValueError, TypeError, KeyError) as fault:
            log.warning("sign-in elsewhere refused", fault=f"{type(fault).__name__}: {fault}")
            raise _refused("its token is not valid") from fault
        self._require_ours(found, journey)
        groups = found.get(self._own.role_claim, ()) if self._own.role_claim else ()
        groups = (groups,) if isinstance(groups, str) else groups
        return Claims(
            issuer=self._own.issuer,
            subject=found["sub"],
            login=_text(found, "preferred_username") or _text(found, "email") or found["sub"],
            name=_text(found, "name"),
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

    def _require_ours(self, found: Mapping[str, Any], journey: Journey) -> None:
        """What the registry does not look at."""
        others = isinstance(found["aud"], list) and len(found["aud"]) > 1
        if found.get("azp", None if others else self._own.client) != self._own.client:
            raise _refused("its token was made for another program")
        if not is_same(str(found["nonce"]), journey.nonce):
            raise _refused("its token was made for another sign-in")
        if not 0 < len(found["sub"]) <= LONGEST_SUBJECT or "\x00" in found["sub"]:
            raise _refused("its token names nobody")


def _http() -> httpx.Client:
    return httpx.Client(timeout=TIMEOUT, follow_redirects=False, trust_env=False)


def _json(http: httpx.Client, method: str, address: str, **sent: Any) -> Json:
    """An object that the provider answered; AwayError where it did not."""
    try:
        with http.stream(method, address, headers={"Accept": "application/json"}, **sent) as answer:
            body = _bounded(answer)
            if answer.status_code in (400, 401) and method == "POST":
                log.warning("sign-in elsewhere refused", fault=body[:500].decode("utf-8", "replace"))
                raise _refused("the provider takes the code for used or foreign")
            if answer.status_code != httpx.codes.OK:
                raise _away(say("{address} answered {status_code}", address=address, status_code=answer.status_code))
            found = httpx.Response(200, content=body).json()
    except (httpx.HTTPError, ValueError) as fault:
        raise _away(f"{address}: {type(fault).__name__}: {fault}") from fault
    if not isinstance(found, dict):
        raise _away(say("{address} answered no object", address=address))
    return found


def _bounded(answer: httpx.Response) -> bytes:
    body = bytearray()
    for part in answer.iter_bytes():
        body += part
        if len(body) > MOST_BYTES:
            raise _away(say("{url} answers without end", url=answer.url))
    return bytes(body)


def _text(found: Mapping[str, Any], name: str) -> str:
    """A claim as text; anything else is none."""
    value = found.get(name)
    return " ".join(value.replace("\x00", "").split())[:200] if isinstance(value, str) else ""


def _refused(why: str) -> SignInError:
    return SignInError(say(REFUSED, why=why))


def _away(fault: str) -> AwayError:
    """What is wrong stands in the log: it is the operator's to mend."""
    log.warning("provider to sign in at", fault=fault)
    return AwayError(SILENT)
