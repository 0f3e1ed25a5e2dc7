"""One of a thing is said as one."""

from datetime import UTC, datetime

import numpy as np
import pytest

from estimator.planning import Missing
from service.outlook.records import DueBasis, DueRule
from service.outlook.words import reason_of
from service.planning.words import missing_in_words


@pytest.mark.parametrize(("done", "said"), [(1, "1 position is done, 2 still"), (3, "3 positions are done, 2 still")])
def test_positions_that_are_done(done: int, said: str) -> None:
    found = Missing(done, None, (("direct", 0.0), ("direct", 1.0)), np.zeros((0, 3)), ())
    assert missing_in_words(found)[0].startswith(said)


@pytest.mark.parametrize(("days", "said"), [(1.0, "at least every 1 day"), (90.0, "at least every 90 days")])
def test_days_between_calibrations(days: float, said: str) -> None:
    basis = DueBasis(DueRule.INTERVAL, datetime(2026, 1, 1, tzinfo=UTC), interval_days=days)
    assert said in reason_of(basis, None)
