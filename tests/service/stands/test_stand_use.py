"""May a stand be used today."""

from datetime import UTC, date, datetime, timedelta

import pytest

from service.stands.records import StandCertificate, StandCondition
from service.stands.words import (
    CHECK,
    EXPIRED_TODAY,
    NOT_STATED,
    READY,
    SOON_OVER,
    StandWord,
    certificate_in_words,
    stand_word,
)

UNTIL = date(2026, 12, 10)
OWN = (StandCertificate("S", "D-K-117", "PTB", date(2025, 12, 10), UNTIL),)
AT = datetime(2026, 3, 1, tzinfo=UTC)


def condition(*, has_shifted: bool) -> StandCondition:
    return StandCondition("S", 9, has_shifted, "why", (), (), (), ())


@pytest.mark.parametrize(
    ("today", "word"),
    [
        (date(2025, 12, 9), NOT_STATED),
        (date(2025, 12, 10), READY),
        (UNTIL - timedelta(days=30), READY),
        (UNTIL - timedelta(days=29), SOON_OVER),
        (UNTIL, SOON_OVER),
        (UNTIL + timedelta(days=1), EXPIRED_TODAY),
    ],
)
def test_a_stand_is_what_its_certificate_is_today(today: date, word: StandWord) -> None:
    assert stand_word(None, OWN, 0, today) == word


@pytest.mark.parametrize(("has_shifted", "flags"), [(True, 0), (False, 1)])
def test_a_stand_at_fault_is_checked_before_use(has_shifted: bool, flags: int) -> None:
    assert stand_word(condition(has_shifted=has_shifted), OWN, flags, AT.date()) == CHECK
    assert stand_word(condition(has_shifted=has_shifted), (), flags, AT.date()) == CHECK


def test_an_expired_certificate_is_worse_than_a_shift() -> None:
    assert stand_word(condition(has_shifted=True), OWN, 3, UNTIL + timedelta(days=1)) == EXPIRED_TODAY


def test_a_certificate_that_is_still_to_come_is_told() -> None:
    assert "10 Dec 2025, in the future" in certificate_in_words(OWN, date(2025, 12, 1))
    assert "No certificate recorded" in certificate_in_words((), date(2025, 12, 1))
