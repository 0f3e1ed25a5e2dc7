"""Secrets that the service gives out: of tokens, of signed-in browsers, of one-time links. Only hashes are stored.

Each holds 256 random bits, so that a plain SHA-256 hides it: there is nothing to guess, unlike with passwords.
"""

import hmac
from functools import cache
from hashlib import sha256
from secrets import token_urlsafe

from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerifyMismatchError

from estimator.message import say

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


SHORTEST = 12
"""Characters: length, not a mixture of signs, is what makes a password hard to guess (NIST SP 800-63B)."""
LONGEST = 1000
"""Characters; hashing a longer one is work that anybody could ask for."""


@cache
def _hasher() -> PasswordHasher:
    return PasswordHasher()


@cache
def _nobody() -> str:
    return _hasher().hash("of nobody")


def hashed(password: str) -> str:
    """What is stored of a password."""
    return _hasher().hash(password)


def is_password(stored: str | None, password: str) -> bool:
    """Whether a password is the stored one. Where there is none it takes as long, so that time tells nothing."""
    try:
        _hasher().verify(stored or _nobody(), password[:LONGEST])
    except (VerifyMismatchError, InvalidHashError):
        return False
    return stored is not None


def fault_of(password: str) -> str | None:
    """What is wrong with a new password; None where nothing is."""
    if len(password) < SHORTEST:
        return say(
            "is shorter than {shortest} characters; a few words in a row are easy to remember and hard to guess",
            shortest=SHORTEST,
        )
    if len(password) > LONGEST:
        return say("is longer than {longest} characters", longest=LONGEST)
    if len(set(password)) < SHORTEST // 3:
        return "repeats the same few characters"
    return None
