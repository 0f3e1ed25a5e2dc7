"""An epoch lasts from one known break up to the next; the moment of a break belongs to what follows it."""

from datetime import UTC, datetime

import pytest

from service.units.store import epoch

MARCH, JUNE, SEPTEMBER = (datetime(2026, month, 1, tzinfo=UTC) for month in (3, 6, 9))
EPOCHS = {
    "before every break": (datetime(2026, 1, 1, tzinfo=UTC), (None, MARCH)),
    "between two": (datetime(2026, 4, 1, tzinfo=UTC), (MARCH, JUNE)),
    "at the moment of one": (JUNE, (JUNE, SEPTEMBER)),
    "after the last": (datetime(2026, 12, 1, tzinfo=UTC), (SEPTEMBER, None)),
}


@pytest.mark.parametrize("when", EPOCHS)
def test_a_time_is_in_the_epoch_of_its_nearest_breaks(when: str) -> None:
    at, expected = EPOCHS[when]
    assert epoch((SEPTEMBER, MARCH, JUNE), at) == expected
