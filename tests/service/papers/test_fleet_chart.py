"""The fleet in one picture: a better verdict is never drawn beyond a worse one, however large U is."""

from itertools import pairwise

import pytest

from service.fleet.records import LAST, STEP, Tally
from service.papers.fleet.charts import bar_by_verdict, fleet_chart
from service.sessions.charts import DATA_FORM
from service.sessions.decision import Verdict

WORSE = (Verdict.PASS, Verdict.CONDITIONAL_PASS, Verdict.CONDITIONAL_FAIL, Verdict.FAIL)


def tally(verdict: Verdict, bar: int) -> Tally:
    """One unit."""
    return Tally(verdict, False, False, bar, 1, 0, 0)


@pytest.mark.parametrize(("better", "worse"), [*pairwise(WORSE)])
def test_a_better_verdict_stands_before_a_worse_one(better: Verdict, worse: Verdict) -> None:
    bars = range(LAST // STEP + 1)
    farthest = max(bar_by_verdict(tally(better, bar)) for bar in bars)
    assert farthest < min(bar_by_verdict(tally(worse, bar)) for bar in bars)


def test_units_that_are_fit_or_unfit_stand_where_their_share_is() -> None:
    chart = fleet_chart([tally(Verdict.PASS, 6), tally(Verdict.FAIL, 15), tally(Verdict.UNDECIDABLE, 70)])
    assert [row["left"] for row in chart.panels[0].datasets[DATA_FORM]] == [60, 150]
