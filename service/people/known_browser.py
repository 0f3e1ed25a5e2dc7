"""A browser that has signed in to an account before says so, with a proof that only the service can make.

The key of the proof follows from what is stored of the password, whose salt nobody outside knows: another password ends
every proof, on every replica, and nothing is stored. A proof opens nothing; it only has attempts counted apart.
"""

import hmac
from datetime import datetime, timedelta
from hashlib import sha256
from secrets import token_urlsafe

from service.people.secret import is_same

LASTS = timedelta(days=365)
"""That a browser is known after it last signed in."""


def cookie_of(login: str) -> str:
    """What the cookie is called, one for each account: several people may use one browser."""
    return f"imu-health-known-{sha256(_plain(login).encode()).hexdigest()[:12]}"


def proof_for(login: str, password_hash: str, now: datetime) -> str:
    """What a browser keeps that has just shown the account's password."""
    said = f"{token_urlsafe(12)}.{int((now + LASTS).timestamp())}"
    return f"{said}.{_sealed(login, password_hash, said)}"


def browser_of(proof: str, login: str, password_hash: str | None, now: datetime) -> str:
    """The identifier of a browser; empty where its proof is none, or is of another account or an earlier
    password."""
    said, _, seal = proof.rpartition(".")
    browser, _, until = said.partition(".")
    holds = is_same(seal, _sealed(login, password_hash or "", said)) and password_hash is not None
    return browser if holds and int(until) > now.timestamp() else ""


def _sealed(login: str, password_hash: str, said: str) -> str:
    key = hmac.digest(password_hash.encode(), b"known browsers of imu-health", sha256)
    return hmac.new(key, "\n".join((_plain(login), said)).encode(), sha256).hexdigest()


def _plain(login: str) -> str:
    return login.strip().lower()
