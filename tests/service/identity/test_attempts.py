"""How often a password may be tried: one bound for all processes on a database, whoever asks at once."""

from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta

import pytest

from service.errors import SignInError, TooOftenError
from service.flows.identity.attempts import BY_ADDRESS, BY_LOGIN, Attempt, attempting
from service.settings import Settings
from service.storage import Storage
from tests.service.identity.staff import NOW
from tests.stock import stores

ATTEMPT = Attempt("k.ito", "203.0.113.9")


def was_looked_at(storage: Storage, attempt: Attempt = ATTEMPT, *, right: bool = False, later: float = 0) -> bool:
    """Whether a password got as far as being looked at."""
    try:
        with attempting(storage, attempt, NOW + timedelta(seconds=later)):
            if not right:
                raise SignInError("wrong")
    except SignInError:
        return True
    except TooOftenError:
        return False
    return True


def test_two_services_on_one_database_count_together(settings: Settings) -> None:
    with stores(settings) as one, stores(settings) as other:
        looked_at = [was_looked_at(storage) for _ in range(BY_LOGIN) for storage in (one, other)]
    assert looked_at == [True] * BY_LOGIN + [False] * BY_LOGIN


def test_of_many_at_once_no_more_get_through(storage: Storage) -> None:
    with ThreadPoolExecutor(12) as pool:
        assert sum(pool.map(lambda _: was_looked_at(storage), range(24))) == BY_LOGIN


def test_after_a_minute_one_may_try_again(storage: Storage) -> None:
    assert [was_looked_at(storage, later=10 * k) for k in range(8)] == [True] * 5 + [False, True, True]


def test_one_password_tried_on_everybody_ends_by_the_address(storage: Storage) -> None:
    tried = [was_looked_at(storage, Attempt(f"user{k}", "203.0.113.9")) for k in range(BY_ADDRESS + 5)]
    assert sum(tried) == BY_ADDRESS
    assert was_looked_at(storage, Attempt("user99", "203.0.113.10"))


def test_the_right_one_forgets_the_wrong_ones(storage: Storage) -> None:
    for _ in range(3):
        assert all(was_looked_at(storage) for _ in range(BY_LOGIN - 1))
        assert was_looked_at(storage, right=True)


def test_what_is_refused_for_another_reason_is_no_wrong_attempt(storage: Storage) -> None:
    for _ in range(2 * BY_LOGIN):
        with pytest.raises(ValueError, match="too short"), attempting(storage, ATTEMPT, NOW):
            raise ValueError("too short")
