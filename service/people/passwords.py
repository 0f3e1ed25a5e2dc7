"""Passwords as argon2id hashes (RFC 9106), never as they were typed."""

from functools import cache

from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerifyMismatchError

from estimator.message import say

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
