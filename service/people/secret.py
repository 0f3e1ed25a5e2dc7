"""Secrets of tokens, of signed-in browsers, of one-time links. Only hashes are stored.

Each has 256 random bits, so that a plain SHA-256 suffices: unlike passwords they cannot be guessed.
"""

import hmac
from functools import cache
from hashlib import sha256
from secrets import token_urlsafe

from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerifyMismatchError

from estimator.message import say

TOKEN_PREFIX = "imuh_"
"""Prefix of every token, so that one leaked into a repository or a log is recognised."""


def new_secret() -> str:
    """43 characters for addresses and cookies."""
    return token_urlsafe(32)


def stored_hash(secret: str) -> str:
    """Stored form of a secret, 64 hexadecimal digits; looked up by hash, so timing reveals nothing."""
    return sha256(secret.encode()).hexdigest()


def csrf_of(secret: str) -> str:
    """CSRF token of a signed-in browser's forms; derived from the cookie, and does not reveal it."""
    return hmac.new(secret.encode(), b"forms of imu-health", sha256).hexdigest()


def is_same(given: str, expected: str) -> bool:
    """Compares in constant time."""
    return hmac.compare_digest(given.encode(), expected.encode())


SHORTEST = 12
"""Characters: length, not variety, makes a password hard to guess (NIST SP 800-63B)."""
LONGEST = 1000
"""Characters; hashing a longer one would be work on anybody's request."""


@cache
def _hasher() -> PasswordHasher:
    return PasswordHasher()


@cache
def _nobody() -> str:
    return _hasher().hash("of nobody")


def hashed(password: str) -> str:
    """Stored form of a password."""
    return _hasher().hash(password)


def is_password(stored: str | None, password: str) -> bool:
    """Whether a password matches the stored one. Without one it takes as long, so that timing reveals nothing."""
    try:
        _hasher().verify(stored or _nobody(), password[:LONGEST])
    except (VerifyMismatchError, InvalidHashError):
        return False
    return stored is not None


def fault_of(password: str) -> str | None:
    """The fault of a new password; None where there is none."""
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
