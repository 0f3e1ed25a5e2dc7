"""Secrets that the service gives out: of tokens, of signed-in browsers, of one-time links. Only hashes are stored.

Each holds 256 random bits, so that a plain SHA-256 hides it: there is nothing to guess, unlike with passwords.
"""

import hmac
from hashlib import sha256
from secrets import token_urlsafe

TOKEN_PREFIX = "imuh_"
"""Of every token, so that one that slipped into a repository or a log is recognised."""


def new_secret() -> str:
    """43 characters that fit into addresses and cookies."""
    return token_urlsafe(32)


def stored_hash(secret: str) -> str:
    """What is stored of a secret, 64 hexadecimal digits; looked up by equality of hashes, so time tells nothing."""
    return sha256(secret.encode()).hexdigest()


def csrf_of(secret: str) -> str:
    """What the forms of a signed-in browser bring back; it follows from the cookie and does not tell it."""
    return hmac.new(secret.encode(), b"forms of imu-health", sha256).hexdigest()


def is_same(given: str, expected: str) -> bool:
    """Compares in constant time."""
    return hmac.compare_digest(given.encode(), expected.encode())
