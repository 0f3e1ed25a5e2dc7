"""A small OpenID provider over real HTTP. It keeps the rules (RFC 6749, RFC 7636), signs by its own hand, and lies
where a test wants it to."""

import base64
import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from hashlib import sha256
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread
from typing import Any
from urllib.parse import parse_qs, unquote, urlencode, urlsplit

from cryptography.hazmat.primitives import hashes
from cryptography.hazmat.primitives.asymmetric import padding, rsa

CLIENT, SECRET = "imu-health", "s3cret/+ of the client"
Json = dict[str, Any]


def plain64(content: bytes) -> str:
    """Base64 as tokens write it."""
    return base64.urlsafe_b64encode(content).rstrip(b"=").decode()


@cache
def made_key(number: int) -> rsa.RSAPrivateKey:
    """A key of its own for each number."""
    return rsa.generate_private_key(65537, 2048)


@dataclass
class OpenId:
    """State of the provider, and the ways in which it lies."""

    now: int
    issuer: str = ""
    person: Json = field(
        default_factory=lambda: {"sub": "248289761001", "preferred_username": "K.Ito", "name": "K. Ito"}
    )
    key: rsa.RSAPrivateKey = field(default_factory=lambda: made_key(1))
    claims: Callable[[Json], Json] = field(default=lambda claims: claims)
    token: Callable[[str], str] = field(default=lambda token: token)
    description: Json = field(default_factory=dict)
    codes: dict[str, Json] = field(default_factory=dict)

    def described(self) -> Json:
        ends = {"authorization_endpoint": "authorize", "token_endpoint": "token", "jwks_uri": "keys"}
        return {"issuer": self.issuer} | {k: f"{self.issuer}/{v}" for k, v in ends.items()} | self.description

    def keys(self) -> Json:
        numbers = self.key.public_key().public_numbers()
        n, e = (plain64(v.to_bytes((v.bit_length() + 7) // 8)) for v in (numbers.n, numbers.e))
        return {"keys": [{"kty": "RSA", "kid": "1", "use": "sig", "alg": "RS256", "n": n, "e": e}]}

    def authorized(self, asked: Json) -> str:
        """Address to which the browser is sent back, once the person has signed in."""
        assert (asked["response_type"], asked["client_id"], asked["code_challenge_method"]) == ("code", CLIENT, "S256")
        assert "openid" in asked["scope"].split()
        code = f"code-{len(self.codes)}"
        self.codes[code] = asked
        return f"{asked['redirect_uri']}?{urlencode({'code': code, 'state': asked['state'], 'iss': self.issuer})}"

    def exchanged(self, shown: str, sent: Json) -> Json | None:
        """The token for a code, once, for the client that began it."""
        own = base64.b64decode(shown.removeprefix("Basic ")).decode().split(":")
        asked = self.codes.pop(sent.get("code", ""), None)
        challenge = plain64(sha256(sent.get("code_verifier", "").encode()).digest())
        if asked is None or [unquote(part) for part in own] != [CLIENT, SECRET]:
            return None
        if (asked["code_challenge"], asked["redirect_uri"]) != (challenge, sent["redirect_uri"]):
            return None
        return {"token_type": "Bearer", "access_token": "x", "id_token": self.token(self.signed(asked["nonce"]))}

    def signed(self, nonce: str) -> str:
        said = {
            "iss": self.issuer,
            "aud": CLIENT,
            "iat": self.now,
            "exp": self.now + 300,
            "nonce": nonce,
        } | self.person
        parts = ({"alg": "RS256", "kid": "1", "typ": "JWT"}, self.claims(said))
        text = ".".join(plain64(json.dumps(part).encode()) for part in parts)
        return f"{text}.{plain64(self.key.sign(text.encode(), padding.PKCS1v15(), hashes.SHA256()))}"


class Handler(BaseHTTPRequestHandler):
    """Addresses of the provider."""

    openid: OpenId

    def log_message(self, *_: object) -> None:
        pass

    def do_GET(self) -> None:
        place = urlsplit(self.path)
        if place.path == "/authorize":
            to = self.openid.authorized({k: v[0] for k, v in parse_qs(place.query).items()})
            self.send_response(302)
            self.send_header("Location", to)
            self.send_header("Content-Length", "0")
            self.end_headers()
        else:
            keys = place.path == "/keys"
            self.answer(200, self.openid.keys() if keys else self.openid.described())

    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers["Content-Length"])).decode()
        sent = {k: v[0] for k, v in parse_qs(body).items()}
        found = self.openid.exchanged(self.headers.get("Authorization", ""), sent)
        self.answer(*((400, {"error": "invalid_grant"}) if found is None else (200, found)))

    def answer(self, status: int, document: Json) -> None:
        body = json.dumps(document).encode()
        self.send_response(status)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)


@contextmanager
def provider(now: int) -> Iterator[OpenId]:
    """A running one."""
    openid = OpenId(now)
    server = ThreadingHTTPServer(("127.0.0.1", 0), type("Own", (Handler,), {"openid": openid}))
    openid.issuer = f"http://127.0.0.1:{server.server_port}"
    thread = Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True)
    thread.start()
    yield openid
    server.shutdown()
    server.server_close()
    thread.join()
